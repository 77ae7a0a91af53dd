"""What an ID and a secret may be, and draws that depend on their seed alone."""

import numpy as np
import pytest

from labsid.rig.seeds import read_secret, student_entropy, uniform_samples

SECRET = b"a secret for the tests alone"


def test_a_composed_letter_is_the_same_id():
    assert student_entropy("Zo\u00eb", SECRET) == student_entropy("Zoe\u0308", SECRET)


@pytest.mark.parametrize("student", ["", " ", "\t\n"])
def test_an_empty_id_is_refused(student):
    with pytest.raises(ValueError, match="student must be an ID; got an empty one"):
        student_entropy(student, SECRET)


@pytest.mark.parametrize("student", [" z1", "z1\n", "z1\r"])
def test_white_space_around_an_id_is_refused(student):
    with pytest.raises(ValueError, match="student must have no white space at its ends; got '"):
        student_entropy(student, SECRET)


@pytest.mark.parametrize("character", ["\0", "\n", "\t", "\x7f", "\u200b", "\u202e", "\ud800", "\u2028"])
def test_control_characters_in_an_id_are_refused(character):
    with pytest.raises(ValueError, match="student must hold no control characters; got '") as error:
        student_entropy(f"z1{character}2", SECRET)
    assert str(error.value).isprintable()


@pytest.mark.parametrize("secret", [b"", b"fifteen bytes.."])
def test_a_short_secret_is_refused(secret):
    with pytest.raises(ValueError, match=f"secret must have at least 16 bytes; got {len(secret)}. Make one"):
        student_entropy("z1", secret)


def test_a_secret_is_read_without_the_white_space_that_editors_add(tmp_path):
    for number, content in enumerate([SECRET, SECRET + b"\n", SECRET + b"\r\n", b"  " + SECRET + b" \n"]):
        path = tmp_path / f"{number}.txt"
        path.write_bytes(content)
        assert read_secret(path) == SECRET


@pytest.mark.parametrize("content", [b"", b"\n" * 40, b"short\n"])
def test_a_secret_file_without_a_secret_is_refused(tmp_path, content):
    path = tmp_path / "course.txt"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"the secret in course\.txt must have at least 16 bytes; got [05]"):
        read_secret(path)


def test_a_secret_file_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_secret(tmp_path / "none.txt")


def test_uniform_samples_are_those_of_numpy_moved_to_the_middle_of_their_cell():
    # `Generator.random` takes the same 53 bits; the half keeps 0 out, whose quantile is minus infinity.
    ours = uniform_samples(np.random.SeedSequence(1), 1000)
    numpys = np.random.Generator(np.random.PCG64(np.random.SeedSequence(1))).random(1000)
    np.testing.assert_allclose(ours, numpys, rtol=0, atol=2.0**-53)
    assert 0 < ours.min() < ours.max() < 1


def test_the_bits_never_change():
    # Recorded once: a student's record must be made again years later, with another numpy.
    recorded = [0.48740329251299724, 0.17924326731342038, 0.9106144830799372]
    assert uniform_samples(np.random.SeedSequence(2018), 3).tolist() == recorded
