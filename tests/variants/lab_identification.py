"""Answers to the lab that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, _lab_part_1, _lab_part_2, _lab_part_3

VARIANTS: list[Right | Wrong] = [*_lab_part_1.VARIANTS, *_lab_part_2.VARIANTS, *_lab_part_3.VARIANTS]
