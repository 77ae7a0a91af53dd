// The page: panels that zoom, sliders and switches of effects, which replay the simulations. Signals are scaled.
const element = (id) => document.getElementById(id);
const decoded = (text, kind) => new kind(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
const made = (tag, properties, ...children) => {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
};
const written = (value, digits = 3) => {
  if (!Number.isFinite(value) || value === 0) return String(value);
  const size = Math.abs(value);
  if (size < 1e-4 || size >= 1e6) return value.toExponential(digits - 1);
  return value.toFixed(Math.max(digits - 1 - Math.floor(Math.log10(Number(size.toPrecision(digits)))), 0));
};

// The data and the library that draws the panels are packed, to less than half their size.
function unpacked(id) {
  const packed = new Blob([decoded(element(id).textContent, Uint8Array)]);
  return new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
}
document.head.append(made("script", { textContent: await unpacked("panel-library") }));

const data = JSON.parse(await unpacked("replay-data"));
const SIGNALS = { u: Float64Array, y: Float32Array, before: Float32Array, after: Float32Array };
// Whole numbers of 2 or 3 bytes: the lowest bytes of all, then the next.
const whole = (text, size) => {
  const bytes = decoded(text, Uint8Array), n = bytes.length / size;
  return Float64Array.from({ length: n }, (_, k) => bytes[k] | (bytes[n + k] << 8) | (size > 2 ? bytes[2 * n + k] << 16 : 0));
};
// A long record has its input in 24 bits, and outputs in steps of 16, whose lowest stands for none; others are counted from y.
const numbers = (packed, kind, y) => {
  if (typeof packed === "string") return decoded(packed, kind);
  if (packed.planes) return whole(packed.planes, 3).map((k) => packed.low + packed.step * k);
  const signed = whole(packed.steps, 2).map((k) => (k === 32768 ? NaN : k > 32768 ? k - 65536 : k));
  return signed.map((k, i) => (packed.on_y ? y[i] : packed.low) + packed.step * k);
};
const parts = Object.entries(data.parts).map(([name, part]) => {
  const kept = Object.entries(SIGNALS).filter(([key]) => key in part);
  const signals = {};
  for (const [key, kind] of kept) signals[key] = Float64Array.from(numbers(part[key], kind, signals.y));
  const t = part.t ? decoded(part.t, Float64Array) : signals.u.map((_, k) => part.start + k * part.Ts);
  const counts = new Uint8Array(t.length);
  for (const [start, stop] of [...part.fitted, ...part.scored]) counts.fill(1, start, stop);
  if (!counts.includes(1)) counts.fill(1);
  return { ...part, ...signals, t, name, counts };
});
const back = (signal, scale) => signal.map((x) => scale.centre + scale.unit * x);
for (const one of data.combinations) {
  for (const kind of ["inputs", "outputs", "additive"]) for (const effect of one.model[kind]) effect.run = RUN[effect.run];
  if (one.constant) one.model.constant = Float64Array.from(decoded(one.constant, Float32Array));
  one.positions = one.sliders.map((slider) => slider.fitted);
}
let chosen = data.combinations.find((one) => one.accepted) ?? null;

// Of several records one is shown, in its own time.
let piece = data.pieces.find((one) => one.worst) ?? null;
for (const one of data.pieces) parts[0].t.set(parts[0].t.slice(one.start, one.start + one.samples).map((t, _, own) => t - own[0]), one.start);
const seen = (signal) => (piece ? signal.slice(piece.start, piece.start + piece.samples) : signal);

// Output of the chosen combination on a part, scaled; that of the simulation before without effects; null if unknown.
// A page that simulates nothing, or in which only numbers were refitted, shows the output after.
function played(part) {
  if (!chosen) return data.combinations.length && !data.refitted ? part.before : part.after;
  const isRecord = part.name === "record";
  const start = isRecord ? chosen : chosen.holdout;
  if (!start) return chosen.accepted ? part.after : null;
  const theta = Float64Array.from(start.theta), gains = Float64Array.from(start.gains);
  chosen.sliders.forEach((slider, i) => {
    if (!isRecord && slider.of_one_record) return;
    const move = slider.moves[chosen.positions[i]];
    for (const [at, by] of slider.theta) theta[at] += move * by;
    for (const [at, by] of slider.gains) gains[at] += move * by;
  });
  const [lower, upper] = chosen.model.bounds;
  const output = simulate(chosen.model, theta.map((x, i) => Math.min(Math.max(x, lower[i]), upper[i])), gains, part.u);
  return output.map((x, k) => (Number.isNaN(part.before[k]) ? NaN : x));  // nothing between several records
}

function rms(part, output, runs) {
  let total = 0, count = 0;
  for (const [start, stop] of runs) {
    for (let k = start; k < stop; k++) { total += (part.y[k] - output[k]) ** 2; count += 1; }
  }
  return Math.sqrt(total / count) * data.y_scale.unit;
}

function errors(outputs) {
  const values = [];
  parts.forEach((part, i) => {
    if (!outputs[i]) return;
    const place = data.pieces.length ? "all records" : part.name === "holdout" ? "holdout record" : "whole record";
    for (const [name, runs] of [[part.name === "holdout" ? place : "scored samples", part.scored], [place, part.fitted]]) {
      if (runs.length) values.push([name, rms(part, outputs[i], runs), rms(part, part.before, runs)]);
    }
  });
  return values;
}

function describe(outputs) {
  element("rms").replaceChildren(...errors(outputs).flatMap(([place, now, before]) => (
    [made("dt", {}, `Rms error, ${place}`), made("dd", {}, `${written(now)} ${data.unit}`), made("dd", {}, `before ${written(before)}`)])));
  const moved = chosen?.positions.some((at, i) => at !== chosen.sliders[i].fitted);
  element("state").textContent = `${chosen ? chosen.title : data.plain}${moved ? ", changed by hand" : ""}. ${chosen?.closed ?? ""}`;
  element("fitted").disabled = !moved;
}

const sources = {};
function show() {
  const outputs = parts.map(played);
  parts.forEach((part, i) => {
    const after = outputs[i] ?? part.y.map(() => NaN);
    const source = sources[part.name];
    const columns = { ...part.columns, after: back(after, data.y_scale), e_after: part.y.map((y, k) => (y - after[k]) * data.y_scale.unit) };
    source.data = Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, seen(values)]));
    part.fit();
  });
  if (data.combinations.length) describe(outputs);
}

// The height of a panel is that of the samples that count, within the times that it shows.
function fit(part, figures) {
  const { data: shown } = sources[part.name];
  const counts = seen(part.counts);
  const columns = { output: ["y", "before", "after"], strip: ["y"], error: ["e_before", "e_after"], input: ["u"] };
  for (const figure of figures) {
    const { start, end } = figure.x_range;
    let low = Infinity, high = -Infinity;
    for (let k = 0; k < shown.t.length; k++) {
      if (shown.t[k] < start || shown.t[k] > end || !(counts[k] || figure.name === "input")) continue;
      for (const column of columns[figure.name]) {
        const value = shown[column][k];
        if (value < low) low = value;
        if (value > high) high = value;
      }
    }
    const margin = 0.07 * (high - low) || 1e-9;
    if (low <= high) figure.y_range.setv({ start: low - margin, end: high + margin });
  }
}

function sliders() {
  const rows = (chosen?.sliders ?? []).map((slider, i) => {
    const id = `slider-${i}`;
    const output = made("output", { htmlFor: id });
    const range = made("input", { type: "range", id, min: 0, max: slider.moves.length - 1, step: 1 });
    const write = () => {
      output.textContent = slider.texts[chosen.positions[i]];
      range.setAttribute("aria-valuetext", output.textContent);
    };
    range.value = chosen.positions[i];
    range.addEventListener("input", () => { chosen.positions[i] = Number(range.value); write(); show(); });
    write();
    return made("div", { className: "slider" }, made("label", { htmlFor: id }, slider.label), range, output);
  });
  element("sliders").replaceChildren(...rows);
  element("fitted").hidden = !rows.length;
  element("still").textContent = chosen?.still ?? "";
}

// Only some combinations are fitted: of those with the effect as it was switched, the nearest to the others as they are.
function switched(name, on) {
  const wanted = new Set(data.effects.map((effect) => effect.name).filter((one) => (one === name ? on : element(`on-${one}`).checked)));
  const distance = (one) => data.effects.filter((effect) => wanted.has(effect.name) !== one.names.includes(effect.name)).length;
  const possible = [...data.combinations, { names: [] }].filter((one) => one.names.includes(name) === on);
  const nearest = possible.reduce((a, b) => (distance(b) < distance(a) ? b : a));
  chosen = nearest.names.length ? nearest : null;
  for (const effect of data.effects) element(`on-${effect.name}`).checked = nearest.names.includes(effect.name);
  sliders();
  show();
}

function controls() {
  element("effects").append(...data.effects.map((effect) => {
    const box = made("input", { type: "checkbox", id: `on-${effect.name}`, checked: chosen?.names.includes(effect.name) ?? false });
    box.addEventListener("change", () => switched(effect.name, box.checked));
    return made("label", { className: "switch" }, box, effect.label);
  }));
  element("fitted").addEventListener("click", () => {
    chosen.positions = chosen.sliders.map((slider) => slider.fitted);
    sliders();
    show();
  });
  sliders();
  element("controls").hidden = false;
}

function turnTo(number) {
  piece = data.pieces[number];
  element("piece").value = number;
  parts[0].look_at_piece();
  show();
}

function choosePiece() {
  const select = element("piece");
  select.append(...data.pieces.map((one, number) => made("option", { value: number }, one.name)));
  select.value = data.pieces.indexOf(piece);
  select.addEventListener("change", () => turnTo(Number(select.value)));
}

// The tags of a model are pairs of a property and a colour of the page.
function paint(models) {
  const style = getComputedStyle(document.documentElement);
  for (const model of models) for (const [property, colour] of model.tags) model[property] = style.getPropertyValue(colour).trim();
}

// A finger scrolls the page; it zooms after one of the buttons above the panels.
function withoutDrag(models) {
  for (const model of models) {
    if (model.type === "Toolbar") model.active_drag = null;
    if (model.type === "BoxZoomTool") model.active = false;
  }
}

// Nothing is folded on paper, also in browsers without `::details-content`.
addEventListener("beforeprint", () => {
  for (const part of document.querySelectorAll("details")) part.open = true;
});

// What a key does to the ends of the times that the panels show, in shares of their length.
const MOVES = { ArrowLeft: [-0.1, -0.1], ArrowRight: [0.1, 0.1], "+": [0.1, -0.1], "=": [0.1, -0.1], "-": [-0.125, 0.125] };
function pressed(event, times, own) {
  if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in MOVES || event.key === "0")) return;
  const [low, high] = [own[0], own[own.length - 1]], length = times.end - times.start;
  let [start, end] = [low, high];
  if (event.key !== "0") {
    const [first, last] = MOVES[event.key];
    start = Math.max(low, times.start + first * length);
    end = Math.min(high, times.end + last * length);
    if (first === last) [start, end] = first < 0 ? [start, start + length] : [end - length, end];
  }
  times.setv({ start, end });
  event.preventDefault();
}

// A ring that one sees around whatever has the focus in the panels, which have styles of their own.
const ring = new CSSStyleSheet();
ring.replaceSync(":focus-visible { outline: 3px solid var(--after) !important; outline-offset: -2px; }");
function withRing(node) {
  for (const { shadowRoot } of node.querySelectorAll("*")) {
    if (!shadowRoot) continue;
    shadowRoot.adoptedStyleSheets = [...shadowRoot.adoptedStyleSheets, ring];
    withRing(shadowRoot);
  }
}

// Either the panels or the figure without a script.
function reveal(live) {
  for (const node of document.querySelectorAll(".live")) node.hidden = !live;
  for (const node of document.querySelectorAll(".still")) node.hidden = live;
}

async function begin() {
  Bokeh.set_log_level("error");
  for (const node of document.querySelectorAll(".live")) node.hidden = false;  // its width is that of the panels
  const dark = matchMedia("(prefers-color-scheme: dark)");
  for (const part of parts) {
    if (part.name === "holdout") element("panels-holdout").before(made("h3", {}, "Holdout record"));
    const views = await Bokeh.embed.embed_item(data.panels[part.name], `panels-${part.name}`);
    const grid = views.roots[0].model;
    const models = [...grid.references()];
    if (matchMedia("(pointer: coarse)").matches) withoutDrag(models);
    const source = models.find((model) => model.name === part.name);
    const y = back(part.y, data.y_scale);
    sources[part.name] = source;
    const before = part.y.map((x, k) => (x - part.before[k]) * data.y_scale.unit);
    part.columns = { t: part.t, u: back(part.u, data.u_scale), y, before: back(part.before, data.y_scale), after: y, e_before: before, e_after: before };
    const figures = models.filter((model) => model.type === "Figure");
    const times = figures.find((model) => model.name === "output").x_range;
    let waits = false;
    part.fit = () => {
      if (!waits) queueMicrotask(() => { waits = false; fit(part, figures); });
      waits = true;
    };
    times.change.connect(part.fit);
    const worst = data.worst[part.name];
    part.look = () => { if (worst) times.setv({ start: worst[0], end: worst[1] }); };
    part.look_at_piece = () => {
      const own = seen(part.t), ends = { start: own[0], end: own[own.length - 1] };
      times.bounds = null;  // those of a shorter record would limit the ends
      times.setv({ ...ends, reset_start: ends.start, reset_end: ends.end, bounds: [ends.start, ends.end] });
    };
    if (piece) part.look_at_piece();
    if (data.long.includes(part.name)) part.look();
    paint(models);
    const panels = element(`panels-${part.name}`);
    panels.addEventListener("keydown", (event) => pressed(event, times, seen(part.t)));
    withRing(panels);
    dark.addEventListener("change", () => paint(models));
    panels.addEventListener("dblclick", () => {
      for (const model of models) if (model.type === "Figure") model.reset.emit();
    });
  }
  if (data.combinations.length) controls();
  if (piece) choosePiece();
  element("worst")?.addEventListener("click", () => {
    if (piece) turnTo(data.pieces.findIndex((one) => one.worst));
    parts.forEach((part) => part.look());
  });
  show();
  reveal(true);
}

begin().catch((failure) => {
  reveal(false);
  throw failure;
});
