"""The sealed check of the gap diagnosis on simulated rigs whose effects are withheld.

`check.run_sealed_check` makes the cases (`suite`, `rows`, `draws`, `strength`), runs the diagnosis on them as a
separate process in an otherwise empty folder (`runner`), compares the answers with the labels and prints the table
(`score`, `metrics`, `honest`, `joints`, `several`, `placed_effects`, `table`). `wrong_answers` lists the records that
are answered wrongly, and keeps them; `kept_answers` compares the answers with those of an earlier version;
`record_folders` writes the records of a row and their labels.
`closure` computes the share of the gap that the true structure, refitted, closes.
Nothing here imports the diagnosis.

How a record is labelled:

- *Gap ratio*: the rms error of the best second-order linear model (output error, offset and initial state free) on
  the noise-free output, divided by the standard deviation of the noise. At least 5 is clear, 1.5 to 5 is hard, at most
  0.1 is none. If the only deviation of a rig is a delay below half a sample, the model gets a third tap.
- The noise is 0.5 to 5 % of the output's standard deviation. The strength of the effect is searched within the range
  of a laboratory. If the effect cannot reach the ratio, rig and input are drawn again.
- A delay below one sample is not an effect, nor is a lag or a mode that a third tap mostly reproduces. The input must
  leave a dead zone on both sides; if it leaves it on one side only, the dead zone is a limit.
- In the rows of clear and hard effects, the input distinguishes the effect from all others: it visits many levels
  for a static curve and keeps moving for a changing gain. Short records give no such guarantee.
- Each effect of a pair is clear alone and leaves at least three times the noise beside the other. Pairs of nearly
  equivalent effects are excluded.
- Sensor noise may be mildly coloured without counting as an effect: its innovations have at least 0.7 of its standard
  deviation. The effect `coloured-noise` is added to this noise.
- In the row `partial`, a clear effect of the table acts beside a smaller one outside it. Alone, that one leaves 0.15 to
  0.4 times the gap ratio, so it stays visible; naming it is not possible, so the right answer is the listed effect with
  a probability above 0.5, and no other effect with one.
- The row `families` has one clear effect of those that the other rows do not draw: an end stop on which the motion
  rests in at least 3 % of the samples and that no overflow imitates, quadratic drag, a slow mode with at least 0.15 of
  the static gain and 6 times the time constant of the rig, or play at the output that the sensor crosses at least six
  times.
- The row `variants` has, clear, dry friction with another value each way, with a break-away peak and smooth about rest,
  a dead zone with a jump and a sensor of the absolute value; and end stops that are not reached, which are no effect.
- The row `runs` has three runs of one rig as short and noisy as the short records, with a hard effect that does not
  depend on time. Input and noise are drawn for each run. The first one is also diagnosed alone.
- The row `honest` has the ordinary records of `labsid.rig.ordinary`; the kinds take turns. Each has its right answers,
  often none. A wrong name counts where its probability is above 0.5 and above 0.9, a record without a report as wrong.
  Free numbers must be within 5 % of the truth, and those that the record does not determine have no standard error.
- In the row `faint`, an effect of the table leaves 0.1 to 1.55 times the noise. Silence is right, and so is its name;
  only wrong names count. The older metrics, the calibration among them, leave these two rows out.
- The row `joints` has the joints of `labsid.rig.switchable.joints`: position loops, speed loops and torques with
  friction of bristles (LuGre, Dahl, growing with the load; the diagnosis has the last two, in another simulation),
  gravity and a limit of the drive, alone and together, and joints without any of them. The best linear model leaves
  at least 5.2 times the noise, and each effect at least 0.05 of that. Right is to name the one without which the linear
  model leaves least, and no wrong name above 0.5.
- The row `several` has two or three effects of the table beside one outside it. The first leaves 12 to 40 times the
  noise alone, the others 0.3 to 0.8 times that, the unlisted one 0.08 to 0.2 times; each listed one leaves at least
  three times the noise if it is missing. Half of the records have a second one of the same rig. Right is that every
  name above 0.5 is one of them; how many of them are named, and how well the probabilities of first, second and third
  names are calibrated, is counted apart.
- The rows `signals` (clear), `signals-hard` and `signals-none` have rigs of two inputs and one or two outputs from
  `labsid.rig.switchable.coupled`, with one effect at one input, at one output or at one place in the dynamics. The gap
  ratio is that of the output on which it is largest, for an output-error model of all inputs and of the order of the
  rig; noise is 0.5 to 3 % of each output. Right is the name of the effect and the signal at which it acts. In the
  dynamics ``signal`` is null; the name of the input or output is as right for a lag or mode there and a load beside it.
  The outputs that the effect changes are counted apart.
- The row `loop` has an upright pendulum, a hanging one and an axis with their controller: the reference, the logged
  input and the output. The linear model of the gap ratio is driven by the logged input; on a rig that is unstable or
  integrates it follows the output by an observer. One record in eight has no effect. Right is the name alone.
- These four rows are made only if they are named (`rows.ON_REQUEST`), and are left out of the older metrics.
- Effects outside the table act through the input or the structure. An unmeasured additive input would count as
  `coloured-noise`.
"""
