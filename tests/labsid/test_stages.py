"""Progress over several stages: one share that never falls and moves in each stage."""

import pytest

from labsid._stages import over_stages


def test_the_share_rises_over_all_stages_and_stays_below_one():
    seen = []
    passed = over_stages(lambda what, share: seen.append((what, share)))
    for stage in range(12):
        for share in (0.0, 0.3, 0.9):
            passed(f"{stage + 1} effects", share)
    shares = [share for _, share in seen]
    assert shares == sorted(shares)
    assert shares[-1] < 1.0
    assert all(later > first for first, later in zip(shares[::3], shares[2::3], strict=True))
    assert [what for what, _ in seen[:4]] == ["1 effects", "1 effects", "1 effects", "2 effects"]


def test_within_one_stage_the_share_is_in_proportion():
    seen = []
    passed = over_stages(lambda what, share: seen.append(share))
    for share in (0.1, 0.2, 0.4):
        passed("one effect", share)
    assert seen[1] / seen[0] == pytest.approx(2.0)
    assert seen[2] / seen[0] == pytest.approx(4.0)
