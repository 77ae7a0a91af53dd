"""What a student tries on the hub, as a program that prints a line for each attempt: "done" or why it was refused."""

BEFORE = """
import os, shutil, zipfile

shared, notebook = {shared!r}, {notebook!r}
# the folder of somebody who has not handed in yet, and names that are those of others
os.mkdir(f"{{shared}}/ada", 0o777)
forged = f"{{shared}}/ada+{assignment}+2020-01-01 00:00:00 UTC+x"
os.mkdir(forged)
for folder in (f"{{shared}}/ada", forged):
    shutil.copyfile(notebook, f"{{folder}}/{assignment}.ipynb")
    os.utime(f"{{folder}}/{assignment}.ipynb", (1577836800, 1577836800))
open(f"{{forged}}/timestamp.txt", "w").write("2020-01-01 00:00:00 UTC")
os.utime(forged, (1577836800, 1577836800))
# links and pipes that the instructor would follow or wait for
os.symlink("/srv/sysid", f"{{shared}}/zoe")
own = f"{{shared}}/mallory"
os.umask(7)
os.mkdir(own, 0o770)
os.symlink("/srv/sysid/course/autograder/source/{assignment}/{assignment}.ipynb", f"{{own}}/solution.ipynb")
os.symlink("/srv/sysid/course/students.csv", f"{{own}}/feedback-{assignment}.html")
os.mkfifo(f"{{own}}/pipe.zip")
os.mkfifo(f"{{shared}}/pipe.zip")
print("prepared")
"""

AFTER = """
import os, subprocess

def tried(what, act):
    try:
        act()
        print("done", what)
    except (OSError, ValueError) as error:
        print("refused", what, type(error).__name__)

shared, file = {shared!r}, {file!r}
victim = os.path.dirname(file)
page = os.path.join(victim, "feedback-{assignment}.html")
tried("list the hand-ins", lambda: os.listdir(shared))
tried("list a hand-in", lambda: os.listdir(victim))
tried("read a hand-in", lambda: open(file, "rb").read())
tried("write into a hand-in", lambda: open(os.path.join(victim, "x.zip"), "wb"))
tried("overwrite a hand-in", lambda: open(file, "r+b"))
tried("rename a folder", lambda: os.rename(victim, victim + "-away"))
tried("remove a folder", lambda: os.rmdir(victim))
tried("replace a folder", lambda: os.rename(os.path.join(shared, "mallory"), victim))
tried("open a folder", lambda: os.chmod(victim, 0o777))
tried("give a file away", lambda: os.chown(os.path.join(shared, "ada", "{assignment}.ipynb"), {uid}, -1))
tried("link a hand-in", lambda: os.link(file, os.path.join(shared, "mallory", "copy.zip")))
tried("join the group", lambda: os.setgid(os.stat(shared).st_gid))
tried("read the feedback of another", lambda: open(page, "rb").read())
tried("read a home folder", lambda: os.listdir({home!r}))
for path in {private!r}:
    tried("read " + path, lambda: open(path, "rb").read())
print("end")
"""

PRIVATE = (
    "/srv/sysid/course/autograder/course-secret",
    "/srv/sysid/course/autograder/source/prelab-sinusoids/prelab-sinusoids.ipynb",
    "/srv/sysid/course/course.toml",
    "/srv/sysid/course/students.csv",
    "/srv/sysid/submitted/students.csv",
    "/srv/sysid/graded/gradebook.db",
    "/srv/sysid/graded/grades.csv",
    "/srv/sysid/graded/feedback/z2/prelab-sinusoids.html",
)
