"""The captions, as printed."""

from labsid.plots import CAPTIONS


def test_every_figure_of_the_lab_has_its_caption():
    assert list(CAPTIONS) == [*(f"Fig. {n}" for n in range(1, 9)), "Fig. A1", "Fig. A2"]


def test_captions_are_sentences_without_the_number():
    for caption in CAPTIONS.values():
        assert caption.endswith(".")
        assert not caption.startswith("Fig")
        assert "  " not in caption


def test_two_captions_word_for_word():
    assert CAPTIONS["Fig. 1"] == ("Comparison of a set of sinusoidal data, (a) Original data, (b) Cut-off data.")
    assert CAPTIONS["Fig. 6"] == (
        "Offset-free data, (a) Offset-free output signal (noise-reduced), (b) Offset-free input signal."
    )
