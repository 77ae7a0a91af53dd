"use strict";
// One answer is current; keys act on it. Every change is saved at once.

const answers = [...document.querySelectorAll("article")];
const message = document.getElementById("message");
const steps = answers.length ? [...answers[0].querySelectorAll("button")].map((button) => button.dataset.step) : [];
let current = -1;

const isOpen = (answer) => answer.classList.contains("wait");
const points = (answer) => answer.querySelector(".points");
const comment = (answer) => answer.querySelector(".comment");
const lines = (answer) => [...answer.querySelectorAll("input[data-line]")];
const ticked = (answer) => lines(answer).filter((line) => line.checked).map((line) => Number(line.dataset.line));

function say(text, isProblem) {
  message.textContent = text;
  message.classList.toggle("problem", Boolean(isProblem));
}

function select(index, focus = true) {
  if (index < 0 || index >= answers.length) return;
  if (current >= 0) answers[current].classList.remove("current");
  current = index;
  answers[current].classList.add("current");
  if (focus) {
    answers[current].focus({ preventScroll: true });
    answers[current].scrollIntoView({ block: "nearest" });
  }
}

function selectOpen() {
  for (let step = 1; step <= answers.length; step++) {
    const index = (current + step + answers.length) % answers.length;
    if (isOpen(answers[index])) return select(index);
  }
  say("Every answer is marked.");
}

// Points are given as a number, or, with a list, by the ticked lines of the rubric.
async function save(answer, score, list = null) {
  const text = comment(answer).value;
  const request = { student: answer.dataset.student, score: score === "" ? null : score, comment: text };
  if (list !== null) request.ticked = list;
  try {
    const reply = await fetch(location.pathname, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(request),
    });
    const found = await reply.json();
    if (!reply.ok) throw new Error(found.error);
    answer.className = found.look + (answer === answers[current] ? " current" : "");
    answer.dataset.score = found.score;
    answer.dataset.comment = text;
    points(answer).value = found.score;
    lines(answer).forEach((line) => { line.checked = found.ticked.includes(Number(line.dataset.line)); });
    answer.dataset.ticked = JSON.stringify(found.ticked);
    answer.querySelector(".state").textContent = found.state;
    document.getElementById("waiting").textContent = answers.filter(isOpen).length;
    say("Saved.");
    return true;
  } catch (error) {
    const before = JSON.parse(answer.dataset.ticked);
    lines(answer).forEach((line) => { line.checked = before.includes(Number(line.dataset.line)); });
    select(answers.indexOf(answer), false);
    say("Not saved: " + (error.message || "the command has ended; start it again."), true);
    return false;
  }
}

async function give(answer, score) {
  const saved = await save(answer, score);
  if (saved && answer === answers[current]) {
    if (current + 1 < answers.length) select(current + 1);
    else answer.focus();
  }
}

answers.forEach((answer, index) => {
  answer.dataset.ticked = JSON.stringify(ticked(answer));
  lines(answer).forEach((line) => line.addEventListener("change", () => save(answer, null, ticked(answer))));
  answer.dataset.comment = comment(answer).value;
  answer.addEventListener("focusin", () => select(index, false));
  answer.addEventListener("click", () => select(index, false));
  answer.querySelectorAll("button").forEach((button) =>
    button.addEventListener("click", () => give(answer, button.dataset.step)));
  points(answer).addEventListener("keydown", (event) => {
    if (event.key === "Enter") {
      event.preventDefault();
      give(answer, points(answer).value.trim());
    } else if (event.key === "Escape") {
      points(answer).value = answer.dataset.score;
      say("");
      answer.focus();
    }
  });
  points(answer).addEventListener("change", () => {
    const value = points(answer).value.trim();
    if (value !== answer.dataset.score) save(answer, value);
  });
  comment(answer).addEventListener("keydown", (event) => {
    if (event.key === "Escape" || (event.key === "Enter" && event.ctrlKey)) {
      event.preventDefault();
      answer.focus();
    }
  });
  comment(answer).addEventListener("change", () => {
    const list = ticked(answer);
    if (comment(answer).value !== answer.dataset.comment) save(answer, answer.dataset.score, list.length ? list : null);
  });
});

document.addEventListener("keydown", (event) => {
  const typing = event.target.closest && event.target.closest("input:not([type=checkbox]), textarea");
  if (typing || event.ctrlKey || event.metaKey || event.altKey || current < 0) return;
  const answer = answers[current];
  const step = steps[Number(event.key)];
  const line = lines(answer)[Number(event.key) - 1];
  if (/^[1-9]$/.test(event.key) && lines(answer).length) {
    if (line === undefined) return;
    line.checked = !line.checked;
    save(answer, null, ticked(answer));
  } else if (/^[0-9]$/.test(event.key) && step !== undefined) give(answer, step);
  else if (event.key === "j" || event.key === "ArrowDown") select(current + 1);
  else if (event.key === "k" || event.key === "ArrowUp") select(current - 1);
  else if (event.key === "u") selectOpen();
  else if (event.key === "x") save(answer, "");
  else if (event.key === "p") points(answer).select();
  else if (event.key === "c") comment(answer).focus();
  else return;
  event.preventDefault();
});

select(Math.max(answers.findIndex(isOpen), 0));
