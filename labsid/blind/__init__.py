"""The sealed check of the gap diagnosis: rigs with withheld effects, judged from outside.

`check.run` makes the cases (`suite`, `rows`, `drawing`, `strength`), has the diagnosis run on them as a separate
process in an otherwise empty folder (`runner`), opens the labels, and prints the table (`score_cases`, `metrics`,
`table`). `closure` says what the true structure, refitted, could have closed. Nothing here imports the diagnosis.

How a record gets its label:

- *Gap*: what the best linear model of second order (output error, offset and initial state free) leaves of the
  noise-free output, over the standard deviation of the noise: 5 and more is clear, 1.5 to 5 hard, at most 0.1 none.
  Where a rig's only peculiarity is a delay below half a sample, a third tap in that model forgives it.
- The noise is 0.5 to 5 % of the output's standard deviation. The strength of the effect is searched for, within
  what a laboratory has; where it cannot be visible on that rig and input, rig and input are drawn again.
- A delay below one sample is no effect. Nor is a lag or a mode for most of which a third tap would do. A dead band
  must be left on both sides: left on one, it is a limit.
- In the rows of clear and hard effects the inputs are such that an effect differs from all others: static curves
  are seen at many levels, a changing gain under an input that keeps moving. Short records are not so kind.
- Both effects of a pair are clear alone, and each leaves at least three times the noise beside the other. Pairs that
  amount to nearly the same are left out.
- Noise of the sensor may be mildly coloured without being an effect: its innovations keep 0.7 of its standard
  deviation. The effect `coloured-noise` comes on top of the floor.
- Effects outside the table all act through the input or the structure. An unmeasured additive input would not be
  unknown, but `coloured-noise`.
"""
