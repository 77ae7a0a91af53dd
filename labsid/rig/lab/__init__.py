"""The coupled-tank rig of the lab: the stand-in record for everybody, and one student's own."""
