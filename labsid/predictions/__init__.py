"""Predict, commit, then see: a student says what will happen, then moves a slider and sees it on their own record.

`prediction` says what a prediction is, `places` lists those of the course, `lab_places` and `other_places` compute
them from `lab_data`. `still` makes text and a picture of one, `widgets` the slider; only the latter needs ipywidgets.
"""
