"use strict";
// Sliders -> one request at a time, of the last state only -> curve, numbers, sentences.

const SVG = "http://www.w3.org/2000/svg";
const by = (id) => document.getElementById(id);
const TAB = String(Math.random()).slice(2);
let sliders = [], number = 0, busy = false, wanted = false, first = null, axis = null, sent = 0;

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
    ask();
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

async function ask() {
  wanted = true;
  if (busy) return;
  busy = true;
  while (wanted) {
    wanted = false;
    sent = performance.now();
    try {
      const reply = await fetch("/curve", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ state: state(), tab: TAB, number: ++number }),
      });
      show(await reply.json());
    } catch {
      show({ problems: ["The server does not answer any more; start rps-exudyn explore again."] });
    }
  }
  busy = false;
}

function terms(holder, values) {
  holder.replaceChildren(...Object.entries(values || {}).map(([name, value]) => {
    const pair = make("div");
    pair.append(make("dt", {}, name), make("dd", {}, value));
    return pair;
  }));
}

function show(answer) {
  if (answer.stale) return;
  document.body.classList.toggle("stale", Boolean(answer.problems));
  by("problems").replaceChildren(...(answer.problems || []).map((text) => make("p", {}, text)));
  if (answer.gear) by("gear").textContent = answer.gear;
  if (answer.geometry) terms(by("geometry"), answer.geometry);
  by("warnings").replaceChildren(...(answer.warnings || []).map((text) => make("li", {}, text)));
  if (!answer.problems) {
    first = first || answer;
    chart(answer);
    terms(by("numbers"), answer.numbers);
    losses(answer.losses);
    by("remarks").textContent = answer.remarks;
    by("accuracy").textContent = answer.accuracy;
  }
  const took = performance.now() - sent;
  by("timing").textContent = answer.ms ? `${answer.ms.toFixed(0)} ms to compute, ${took.toFixed(0)} ms from slider to curve` : "";
  document.body.dataset.answered = number;
  document.body.dataset.took = took.toFixed(1);
}

function losses(shares) {
  by("losses").replaceChildren(...Object.entries(shares).map(([name, share]) => {
    const bar = make("div", { class: "bar" }), svg = document.createElementNS(SVG, "svg");
    svg.setAttribute("viewBox", "0 0 100 10");
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    drawn(svg, "rect", { width: Math.max(share, 0), height: 10 });
    bar.append(make("span", {}, name), svg, make("span", {}, `${share.toFixed(1)} %`));
    return bar;
  }));
}

function step(span, most) {
  const power = 10 ** Math.floor(Math.log10(span / most || 1));
  return [1, 2, 5, 10].map((each) => each * power).find((each) => each >= span / most) || power;
}

// The ordinate starts at zero and changes only where the curve leaves it, so that it does not jump
function ordinate(torques) {
  const [low, high] = [Math.min(0, ...torques), Math.max(...torques)];
  if (!axis || high > axis[1] || high < 0.4 * axis[1] || low < axis[0]) {
    const by = step(1.25 * (high - low) || 1, 5);
    axis = [by * Math.floor(low / by), by * Math.ceil((1.15 * high) / by) || by];
  }
  return axis;
}

function chart(answer) {
  const width = Math.max(by("chart").clientWidth, 280), height = Math.min(330, 0.62 * width);
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const [left, right, top, bottom] = [46, width - 14, 20, height - 30];
  const [low, high] = ordinate([...answer.torque, ...first.torque]);
  const end = answer.angle.at(-1), begin = answer.angle[0];
  const x = (angle) => left + ((angle - begin) / (end - begin || 1)) * (right - left);
  const y = (torque) => bottom - ((torque - low) / (high - low)) * (bottom - top);
  const by_ = step(high - low, 5);
  for (let at = low; at <= high + 1e-9; at += by_) {
    drawn(svg, "line", { x1: left, x2: right, y1: y(at), y2: y(at), class: "grid" });
    drawn(svg, "text", { x: left - 6, y: y(at) + 4, "text-anchor": "end" }, shown(at.toFixed(9)));
  }
  for (let at = 0; at <= 360; at += width < 420 ? 90 : 60) {
    drawn(svg, "text", { x: x(at), y: bottom + 16, "text-anchor": "middle" }, String(at));
  }
  drawn(svg, "text", { x: 2, y: 12 }, "torque [N m]");
  drawn(svg, "text", { x: right, y: height - 2, "text-anchor": "end" }, "pinion angle [°]");
  if (answer.error) {
    const mean = answer.torque.reduce((sum, value) => sum + value, 0) / answer.torque.length;
    const [a, b] = [y(mean * (1 + answer.error)), y(mean * (1 - answer.error))];
    drawn(svg, "rect", { x: left, width: right - left, y: Math.min(a, b), height: Math.abs(b - a), class: "band" });
  }
  const line = (curve) => curve.angle.map((angle, k) => `${x(angle).toFixed(1)},${y(curve.torque[k]).toFixed(1)}`).join(" ");
  if (first !== answer) drawn(svg, "polyline", { points: line(first), class: "start" });
  drawn(svg, "polyline", { points: line(answer), class: "now" });
  by("chart").replaceChildren(svg);
}

async function save() {
  const reply = await fetch("/gear", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ state: state() }),
  });
  if (!reply.ok) {
    show(await reply.json());
    return;
  }
  const link = make("a", { href: URL.createObjectURL(await reply.blob()), download: "gear.toml" });
  link.click();
  by("command").textContent = "gear.toml is written by your browser; go on with: rps-exudyn run --gear gear.toml";
}

async function begin() {
  sliders = (await (await fetch("/sliders")).json()).map(slider);
  by("sliders").replaceChildren(...sliders.map(({ row }) => row));
  by("save").addEventListener("click", save);
  by("reset").addEventListener("click", () => {
    for (const { item, input, tell } of sliders) {
      input.value = item.value;
      tell();
    }
    ask();
  });
  ask();
}

begin();
