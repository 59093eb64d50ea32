"use strict";
// Sliders -> one request at a time, of the last state only -> curve, numbers, sentences.

const SVG = "http://www.w3.org/2000/svg";
const by = (id) => document.getElementById(id);
const SILENT = "The server does not answer any more; start rps-exudyn explore again.";
const MOVED = "Sliders or limits have changed since the window was asked for; press the button again.";
const TAB = String(Math.random()).slice(2);
let sliders = [], scenes = {}, number = 0, busy = false, wanted = false, first = null, axis = null, sent = 0;
let slow = Infinity, drafts = false, drafted = false; // time of an answer from which on its scene is drafted while a slider moves [ms]
let latest = null, band = null, measured = null, file = null, resting = 0, turned = null;
let limits = {}, read = {}, readings = 0; // metric -> least and most as typed, and as the server reads them
let windowed = ""; // scene of whose metrics windows keep the limits; "" without windows
const fields = new Map(); // metric of the scene -> its row of limits
const POLL = 500; // between questions how far a request is [ms]
const LATE = 1500; // after which a curve's progress is shown [ms]
const running = new Set(); // kinds of clicks without an answer
const REST = 500; // after which the address and the gear's picture follow the sliders [ms]

function make(kind, attributes = {}, text) {
  const item = document.createElement(kind);
  for (const [name, value] of Object.entries(attributes)) item.setAttribute(name, value);
  if (text !== undefined) item.textContent = text;
  return item;
}

function drawn(parent, kind, attributes, text) {
  const item = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) item.setAttribute(name, value);
  if (text !== undefined) item.textContent = text;
  parent.append(item);
  return item;
}

const shown = (value) => String(Number(Number(value).toPrecision(6)));

// Only what was moved is sent: what follows from it stays free to follow
function state() {
  const moved = sliders.filter(({ item, input }) => Number(input.value) !== item.value);
  return Object.fromEntries(moved.map(({ item, input }) => [item.path, Number(input.value)]));
}

function slider(item) {
  const row = make("div", { class: "slider" }), id = item.path.replace(".", "-");
  const input = make("input", { id, type: "range", min: item.low, max: item.high, step: "any", title: item.meaning });
  const output = make("output", { for: id });
  input.value = item.value;
  row.append(make("label", { for: id }, item.name), output, input);
  const tell = () => {
    const text = `${shown(input.value)} ${item.unit}`.trim();
    output.textContent = text;
    input.setAttribute("aria-valuetext", text);
    row.classList.toggle("changed", Number(input.value) !== item.value);
  };
  input.addEventListener("input", () => {
    const steps = Math.round((Number(input.value) - item.low) / item.step); // on the grid, or at the start
    const near = Math.abs(Number(input.value) - item.value) < item.step / 2;
    input.value = near ? item.value : shown(Math.min(item.low + steps * item.step, item.high));
    tell();
    changed();
  });
  input.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageUp: 10, PageDown: -10 }[event.key];
    if (!way) return;
    event.preventDefault();
    input.value = Number(input.value) + way * item.step;
    input.dispatchEvent(new Event("input"));
  });
  tell();
  return { item, input, tell, row };
}

const asked = () => ({ state: state(), scene: by("scene").value, both_ways: by("both-ways").checked, tab: TAB });

// The frame of a notebook hands requests over; elsewhere the server takes them
const FRAME = window.frameElement?.rpsPost ? window.frameElement : null;
const post = (path, content) => (FRAME ? FRAME.rpsPost(path, content) : fetched(path, content));

async function fetched(path, content) {
  const reply = await fetch(`/${path}`, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(content),
  });
  return reply.json();
}

const key = () => JSON.stringify([state(), by("scene").value, by("both-ways").checked]);

const dynamic = () => scenes[by("scene").value].dynamic;

// Another scene, of which nothing is known yet; one of dynamics is simulated by a click
function fresh() {
  first = axis = latest = null;
  drafts = false;
  by("simulate").hidden = !dynamic();
  by("window").hidden = by("scene").value !== windowed;
  for (const { row } of fields.values()) row.remove();
  fields.clear();
  for (const id of ["chart", "rows", "losses", "caption", "remarks", "accuracy"]) by(id).replaceChildren();
  changed();
}

// A band and a window belong to the state for which they were computed
function changed() {
  band = null;
  by("window-found").replaceChildren();
  ask();
}

async function ask() {
  wanted = true;
  if (busy) return;
  busy = true;
  while (wanted) {
    wanted = false;
    sent = performance.now();
    drafted = drafts;
    try {
      show(await curve({ draft: drafted, number: ++number }));
    } catch {
      show({ problems: [SILENT] });
    }
  }
  busy = false;
  clearTimeout(resting);
  resting = setTimeout(rest, REST);
}

// The answer to the present state; one that is late, as the first of a scene is, shows how far it is
async function curve(more) {
  let ended = () => {};
  const late = setTimeout(() => { ended = followed("curve", "Curve"); }, LATE);
  try {
    return await post("curve", { ...asked(), ...more });
  } finally {
    clearTimeout(late);
    ended();
  }
}

// The answer to a state that was drafted; none if a slider has moved meanwhile
async function settle() {
  const mine = ++number;
  try {
    const answer = await curve({ number: mine });
    if (mine === number) show({ ...answer, settled: true });
  } catch {
    show({ problems: [SILENT] });
  }
}

function address() {
  const { state: moved, scene, both_ways } = asked();
  if (!FRAME) history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify({ state: moved, scene, both_ways, limits }))}`);
}

// When the sliders rest, address and picture follow
function rest() {
  if (drafted) settle();
  address();
  click("picture", null, (found) => {
    if (turned) {
      turn(found.page);
      return;
    }
    const image = make("img", { src: found.image, alt: found.alt });
    const labels = found.labels.map(({ name, value, part, side, left, top }) => {
      const label = make("span", { class: side });
      label.append(make("b", { class: part }, name), make("i", {}, ` ${value}`));
      label.style.left = `${left}%`;
      label.style.top = `${top}%`;
      return label;
    });
    const forces = document.createElementNS(SVG, "svg");
    forces.setAttribute("viewBox", `0 0 ${found.size.join(" ")}`);
    for (const { part, line, head } of found.arrows) {
      for (const halo of ["halo ", ""]) {
        drawn(forces, "polyline", { points: line, class: halo + part });
        drawn(forces, "polygon", { points: head, class: halo + part });
      }
    }
    const button = make("button", { type: "button" }, "Turn it in 3-D");
    button.addEventListener("click", () => {
      turned = { frame: make("iframe", { title: "The gear in three dimensions" }), packed: "" };
      by("picture").replaceChildren(turned.frame);
      by("picture").closest(".pair").classList.add("turned");
      turn(found.page);
    });
    by("picture").replaceChildren(image, forces, ...labels, ...("DecompressionStream" in window ? [button] : []));
  });
}

// The page in three dimensions of the present gear, seen as the earlier one was
async function turn(packed) {
  if (packed === turned.packed) return;
  turned.packed = packed;
  const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
  const text = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  const seen = turned.frame.contentWindow?.rpsView?.get();
  turned.frame.addEventListener("load", () => seen && turned.frame.contentWindow.rpsView.set(seen), { once: true });
  turned.frame.srcdoc = text;
}

// What takes longer than a curve: asked for by a click, answered beside the curves
async function click(kind, button, use, more = {}) {
  const ended = button ? followed(kind, button.textContent, button) : () => {};
  document.body.dataset.waiting = kind;
  running.add(kind);
  try {
    const found = await post(kind, { ...asked(), ...more });
    if (found.problems) said(found.problems);
    else if (!found.cancelled) use(found);
  } catch {
    said([SILENT]);
  }
  running.delete(kind);
  delete document.body.dataset.waiting;
  ended();
}

// A row that shows how far a request is, and cancels that of a button; the function that is returned removes it
function followed(kind, name, button = null) {
  const row = make("p", { class: "job" }), text = make("span", {}, "computing"), bar = make("progress", { max: 1 });
  const question = () => ({ state: {}, tab: TAB, of: kind });
  row.append(make("b", {}, name), bar, text);
  if (button) {
    const cancel = make("button", { type: "button", "aria-label": `Cancel: ${name}` }, "Cancel");
    cancel.addEventListener("click", () => {
      cancel.disabled = true;
      post("cancel", question());
    });
    row.append(cancel);
    button.disabled = true;
  }
  by("jobs").append(row);
  const asking = setInterval(async () => {
    const found = await post("progress", question());
    if (found.text) text.textContent = found.text;
    if (Number.isFinite(found.fraction)) bar.value = found.fraction;
  }, POLL);
  return () => {
    clearInterval(asking);
    row.remove();
    if (button) button.disabled = false;
  };
}

const said = (sentences) => by("said").replaceChildren(...sentences.map((text) => make("p", {}, text)));

function terms(holder, values) {
  holder.replaceChildren(...values.map(([name, value, vague]) => {
    const pair = make("div", vague ? { class: "vague" } : {});
    pair.append(make("dt", {}, name), make("dd", {}, value));
    return pair;
  }));
}

function show(answer) {
  if (answer.stale) return;
  const waits = answer.on_request || (answer.of && answer.of !== key());
  document.body.classList.toggle("stale", Boolean(answer.problems || waits));
  by("hint").hidden = !waits;
  by("problems").replaceChildren(...(answer.problems || []).map((text) => make("p", {}, text)));
  if (answer.gear) by("gear").textContent = answer.gear;
  if (answer.geometry) terms(by("geometry"), Object.entries(answer.geometry));
  by("warnings").replaceChildren(...(answer.warnings || []).map((text) => make("li", {}, text)));
  if (!answer.problems && !answer.on_request) {
    latest = answer;
    first = first || answer;
    chart();
    terms(by("rows"), answer.rows);
    answer.metrics.forEach(field);
    losses(answer.losses);
    by("remarks").textContent = answer.remarks;
    by("accuracy").textContent = answer.accuracy;
  }
  judge();
  const took = performance.now() - sent;
  if (answer.ms && !answer.draft && !answer.of) drafts = answer.ms > slow;
  const waited = answer.of || answer.settled ? "" : `, ${took.toFixed(0)} ms from slider to curve`;
  by("timing").textContent = answer.ms ? `${answer.ms.toFixed(0)} ms to compute${waited}` : "";
  document.body.dataset.answered = number;
  document.body.dataset.took = took.toFixed(1);
}

function losses(shares) {
  by("losses").replaceChildren(...shares.map(([part, name, share]) => {
    const bar = make("div", { class: "bar" }), svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", "0 0 100 10");
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    drawn(svg, "rect", { width: Math.max(share, 0), height: 10, class: part });
    bar.append(make("span", {}, name), svg, make("span", {}, `${share.toFixed(0)} %`));
    return bar;
  }));
}

// Where limits of a metric are typed, and the verdict stands
function field({ name, words, unit }) {
  if (fields.has(name)) return;
  const row = make("div", { class: "limit" }), verdict = make("output");
  const title = make("b", {}, words);
  title.append(make("span", {}, unit && `, ${unit}`));
  row.append(title);
  for (const [end, said] of [["least", "at least"], ["most", "at most"]]) {
    const label = make("label", {}, `${said} `), input = make("input", { size: 7, maxlength: 40, autocomplete: "off", "aria-label": `${words}, ${said}` });
    input.value = limits[name]?.[end] ?? "";
    input.addEventListener("change", () => {
      const { [end]: _, ...others } = limits[name] ?? {}, ends = input.value.trim() ? { ...others, [end]: input.value } : others;
      limits = { ...limits, [name]: ends };
      if (!Object.keys(ends).length) delete limits[name];
      address();
      readLimits();
    });
    label.append(input);
    row.append(label);
  }
  row.append(verdict);
  by("limits").append(row);
  by("limits").hidden = false;
  fields.set(name, { row, verdict, words });
}

async function readLimits() {
  const mine = ++readings;
  by("window-found").replaceChildren();
  const found = await post("limits", { state: {}, limits }).catch(() => ({ problems: [SILENT] }));
  if (mine !== readings) return;
  read = found.limits ?? {};
  if (found.problems) said(found.problems);
  judge();
}

// The window of a parameter within the typed limits
function findWindow({ target }) {
  const present = () => key() + JSON.stringify(limits), of = present();
  said([]);
  click("window", target, ({ rows, lead, images }) => {
    if (of !== present()) {
      said([MOVED]);
      return;
    }
    const list = make("dl", { class: "rows" }), place = by("chart").clientWidth < 500 ? "narrow" : "wide-only";
    terms(list, rows);
    by("window-found").replaceChildren(list, make("img", images[place]), make("p", { class: "faint" }, lead));
  }, { limits });
}

// Whether the gear of the present curve keeps each limit, in words
function judge() {
  const there = document.body.classList.contains("stale") ? [] : latest?.metrics ?? [];
  const found = { kept: [], "not kept": [], "too close to tell": [], "not computed": [], "not understood": [] };
  for (const [name, { verdict, words }] of fields) {
    const limit = read[name], { value, error, shown: text } = there.find((each) => each.name === name) ?? {};
    let word = "not computed";
    if (limit?.problems) word = "not understood";
    else if (value !== undefined) {
      const inside = Math.min(value - (limit?.least ?? -Infinity), (limit?.most ?? Infinity) - value); // negative outside
      if (Math.abs(inside) < (error ?? Infinity)) word = "too close to tell"; // null is an unknown error
      else word = inside >= 0 ? "kept" : "not kept";
    }
    if (limit) found[word].push(words);
    verdict.textContent = !limit ? "" : limit.problems ? limit.problems.join(" ") : `${word}${text ? `: ${text}` : ""} (${limit.shown})`;
    verdict.classList.toggle("broken", word === "not kept" || word === "not understood");
  }
  const parts = Object.entries(found).filter(([, names]) => names.length).map(([word, names]) => `${word}: ${names.join("; ")}`);
  const draft = latest?.draft ? " (draft)" : "";
  by("verdict").replaceChildren(...parts.map((text) => make("span", { class: text.startsWith("not") ? "broken" : "" }, `Limits ${text}${draft}. `)));
}

function step(span, most) {
  const power = 10 ** Math.floor(Math.log10(span / most || 1));
  return [1, 2, 5, 10].map((each) => each * power).find((each) => each >= span / most) || power;
}

// The ordinate holds all data and changes only where they leave it or fill less than a third, so that it does not jump
function ordinate(values) {
  const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b));
  const span = high - low || Math.abs(high) || 1;
  if (!axis || high > axis[1] || low < axis[0] || span < 0.3 * (axis[1] - axis[0])) {
    const by = step(1.2 * span, 5);
    axis = [by * Math.floor((low - 0.1 * span) / by), by * Math.ceil((high + 0.1 * span) / by)];
  }
  return axis;
}

// Measured angles are brought onto the simulated ones by whole turns
function wrapped(x, [begin, end]) {
  if (end - begin < 359) return x;
  return x >= begin && x <= end ? x : begin + ((((x - begin) % 360) + 360) % 360);
}

function chart() {
  if (!latest) return;
  const answer = latest, same = first.across.name === answer.across.name && first.along.name === answer.along.name;
  const width = Math.max(by("chart").clientWidth, 280), height = Math.min(340, 0.66 * width);
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const [left, right, top, bottom] = [52, width - 14, 22, height - 32];
  const older = same && first !== answer ? first.curves : [];
  const points = measured && answer.across.name === "pinion torque" && answer.along.name === "pinion angle" ? measured : [];
  const xs = answer.curves.flatMap((curve) => curve.x);
  const [begin, end] = [xs.reduce((a, b) => Math.min(a, b)), xs.reduce((a, b) => Math.max(a, b))];
  const shades = band ? band.band.flatMap((part) => [...part.low, ...part.high]) : [];
  const friction = answer.curves.every((curve) => curve.y.every((value) => value > 0)); // no load, spring or reversal
  const begins = (part) => (friction ? part.at_reversal : 0); // rows before the torque runs
  const ys = [...answer.curves, ...older].flatMap((curve) => curve.y);
  for (const part of points) ys.push(...part.y.slice(begins(part)));
  const [low, high] = ordinate([...ys, ...shades]);
  const x = (value) => left + ((value - begin) / (end - begin || 1)) * (right - left);
  const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
  const by_ = step(high - low, 5);
  for (let at = low; at <= high + 1e-9 * by_; at += by_) {
    drawn(svg, "line", { x1: left, x2: right, y1: y(at), y2: y(at), class: "grid" });
    drawn(svg, "text", { x: left - 6, y: y(at) + 4, "text-anchor": "end" }, shown(at.toFixed(9)));
  }
  const turns = answer.along.unit === "\u00b0" && end - begin > 100;
  const along = turns ? (width < 420 ? 90 : 60) * Math.ceil((end - begin) / 400) : step(end - begin, 5);
  for (let at = along * Math.ceil(begin / along - 1e-9); at <= end + 1e-9 * along; at += along) {
    drawn(svg, "text", { x: x(at), y: bottom + 16, "text-anchor": "middle" }, shown(at.toFixed(9)));
  }
  const zero = low > 0 || high < 0 ? "; axis does not begin at 0" : "";
  drawn(svg, "text", { x: 2, y: 12 }, `${answer.across.name}, ${answer.across.unit}${zero}`);
  drawn(svg, "text", { x: right, y: height - 2, "text-anchor": "end" }, `${answer.along.name}, ${answer.along.unit}`);
  for (const part of band ? band.band : []) {
    for (const [name, a, b] of [["outer", "low", "high"], ["inner", "inner_low", "inner_high"]]) {
      const there = part.x.map((value, k) => `${x(value).toFixed(1)},${y(part[a][k]).toFixed(1)}`);
      const back = part.x.map((value, k) => `${x(value).toFixed(1)},${y(part[b][k]).toFixed(1)}`).reverse();
      drawn(svg, "polygon", { points: [...there, ...back].join(" "), class: name });
    }
  }
  if (answer.error && answer.curves.length === 1) {
    const mean = answer.curves[0].y.reduce((sum, value) => sum + value, 0) / answer.curves[0].y.length;
    const [a, b] = [y(mean * (1 + answer.error)), y(mean * (1 - answer.error))];
    drawn(svg, "rect", { x: left, width: right - left, y: Math.min(a, b), height: Math.abs(b - a), class: "band" });
  }
  for (const part of points) {
    const some = Math.ceil(part.x.length / 400);
    part.x.forEach((value, k) => {
      const at = wrapped(value, [begin, end]);
      if (at < begin || at > end) return;
      if (k < begins(part)) drawn(svg, "path", { d: `M${x(at).toFixed(1)},${bottom}l-3.5,-6h7z`, class: "measured back" });
      if (k < begins(part) || k % some) return;
      drawn(svg, "circle", { cx: x(at).toFixed(1), cy: y(part.y[k]).toFixed(1), r: part.direction > 0 ? 2 : 1.4, class: part.direction > 0 ? "measured" : "measured back" });
    });
  }
  const line = (curve) => curve.x.map((value, k) => `${x(value).toFixed(1)},${y(curve.y[k]).toFixed(1)}`).join(" ");
  const way = (curve) => (curve.direction < 0 ? " back" : "");
  for (const curve of older) drawn(svg, "polyline", { points: line(curve), class: `start${way(curve)}` });
  for (const curve of answer.curves) drawn(svg, "polyline", { points: line(curve), class: `now${way(curve)}` });
  by("chart").replaceChildren(svg);
  const parts = answer.draft ? [answer.draft] : [];
  if (answer.curves.length > 1) parts.push("line: towards +X, dashed: towards \u2212X, each against the motion");
  if (older.length) parts.push("thin: the gear at the start");
  if (answer.error && answer.curves.length === 1) parts.push("shaded: the mean with the error of the contact law");
  if (band) parts.push(`grey: ${band.levels[1]} % and ${band.levels[0]} % of ${band.gears} gears of a series`);
  if (points.length) parts.push(`dots: ${file.name}`);
  if (points.some(begins)) parts.push("\u25bc: just after a reversal, beyond the axis");
  by("caption").textContent = parts.join("; ");
}

function keep(name, content, kind) {
  const link = make("a", { href: URL.createObjectURL(new Blob([content], { type: kind })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function save() {
  const found = await post("gear", asked());
  if (found.problems) {
    show(found);
    return;
  }
  keep("gear.toml", found.file, "application/toml");
  const ways = by("both-ways").checked ? " --set test.path=there-and-back" : "";
  by("command").textContent = `gear.toml is written by your browser; go on with: rps-exudyn run ${by("scene").value} --gear gear.toml${ways}`;
}

function python() {
  const ways = by("both-ways").checked ? '.replace({"test.path": "there-and-back"})' : "";
  keep("explored.py", `import rps_exudyn as rps

gear = rps.SteeringGear.from_toml("gear.toml")${ways}  # the gear file of the same page
result = rps.run("${by("scene").value}", gear, fidelity="${dynamic() ? "flank" : "quasi-static"}")
print(result.summary)
`, "text/x-python");
}

async function take(chosen) {
  if (!chosen) return;
  const content = await asBase64(chosen);
  await click("measured", null, (found) => {
    file = { name: chosen.name, content };
    measured = found.measured;
    by("fit").hidden = by("forget").hidden = false;
    said([`${chosen.name}: ${found.assumed.join("; ")}.`]);
    if (new Set(measured.map(({ direction }) => direction)).size > 1 && !by("both-ways").checked) {
      by("both-ways").checked = true; // as the file turns
      fresh();
    } else if (latest) chart();
  }, { measured: content });
}

// The bytes of a file: the server finds its encoding, and reads binary ones
function asBase64(chosen) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(",") + 1));
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(chosen);
  });
}

function set(values) {
  for (const { item, input, tell } of sliders) {
    if (!(item.path in values) || !Number.isFinite(Number(values[item.path]))) continue;
    input.value = values[item.path];
    tell();
  }
}

function fromAddress() {
  try {
    const found = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    set(found.state ?? {});
    if ([...by("scene").options].some(({ value }) => value === found.scene)) by("scene").value = found.scene;
    by("both-ways").checked = found.both_ways === true;
    limits = found.limits ?? {};
    by("limits").open = Object.keys(limits).length > 0;
  } catch {
    // an address without a state
  }
}

async function begin() {
  const found = await post("sliders", { state: {} });
  sliders = found.sliders.map(slider);
  by("sliders").replaceChildren(...sliders.map(({ row }) => row));
  scenes = found.scenes;
  slow = found.slow;
  windowed = found.window;
  by("scene").replaceChildren(...Object.entries(scenes).map(([value, { title }]) => make("option", { value }, title)));
  for (const id of ["scene", "both-ways"]) by(id).addEventListener("change", fresh);
  by("simulate").addEventListener("click", ({ target }) => {
    const of = key();
    click("simulation", target, (answer) => show({ ...answer, of }));
  });
  window.addEventListener("pagehide", () => {
    if (FRAME) return;
    for (const kind of running) {
      const content = JSON.stringify({ state: {}, tab: TAB, of: kind });
      navigator.sendBeacon("/cancel", new Blob([content], { type: "application/json" }));
    }
  });
  by("save").addEventListener("click", save);
  by("python").addEventListener("click", python);
  by("sheet").addEventListener("click", ({ target }) => click("sheet", target, ({ page }) => keep("sheet.html", page, "text/html")));
  by("band").addEventListener("click", ({ target }) => click("band", target, (answer) => { band = answer; chart(); }));
  by("window").addEventListener("click", findWindow);
  by("pattern").addEventListener("click", ({ target }) => click("pattern", target, ({ image }) => {
    by("pattern-picture").replaceChildren(make("img", { src: image, alt: "contact pattern of the flanks" }));
  }));
  by("fit").addEventListener("click", ({ target }) => click("fit", target, (answer) => {
    set(answer.state);
    said(answer.sentences);
    changed();
  }, { measured: file?.content }));
  by("forget").addEventListener("click", () => {
    file = measured = null;
    by("fit").hidden = by("forget").hidden = true;
    said([]);
    chart();
  });
  by("file").addEventListener("change", ({ target }) => take(target.files[0]));
  document.addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over"); });
  document.addEventListener("dragleave", () => document.body.classList.remove("over"));
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    document.body.classList.remove("over");
    take(event.dataTransfer.files[0]);
  });
  by("reset").addEventListener("click", () => {
    set(Object.fromEntries(sliders.map(({ item }) => [item.path, item.value])));
    changed();
  });
  fromAddress();
  readLimits();
  fresh();
}

begin();
