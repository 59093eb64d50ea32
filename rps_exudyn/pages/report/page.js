"use strict";
// Values under the pointer for curves in charts. The chart is matplotlib's SVG: points are read from its paths,
// and the figure says where its axes are. Arrow keys do what the pointer does.
const SVG = "http://www.w3.org/2000/svg";
const ROUNDING = 0.02; // of places in the SVG
const FEW = 6; // curves of a panel that are all told; of more only the nearest to the pointer

for (const gear of document.querySelectorAll(".gear")) turnable(gear);
for (const figure of document.querySelectorAll("figure[data-axes]")) follow(figure);

// The still becomes the page in three dimensions, which stands packed in the same file
function turnable(gear) {
  const button = gear.querySelector("button");
  if (!("DecompressionStream" in window)) return;
  button.hidden = false;
  button.addEventListener("click", async () => {
    const packed = Uint8Array.from(atob(gear.dataset.page), (letter) => letter.charCodeAt(0));
    const text = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
    const frame = document.createElement("iframe");
    frame.title = "The gear in three dimensions";
    frame.srcdoc = text;
    gear.closest(".top").classList.add("turned");
    gear.replaceChildren(frame);
  });
}

function follow(figure) {
  const svg = figure.querySelector("svg");
  const panels = JSON.parse(figure.dataset.axes);
  for (const panel of panels) {
    for (const curve of panel.curves) curve.points = pointsOf(svg.querySelector(`[data-curve="${curve.number}"] path`));
  }
  const marks = svg.appendChild(document.createElementNS(SVG, "g"));
  const told = figure.insertBefore(document.createElement("output"), figure.querySelector("figcaption"));
  told.textContent = "\u2190 \u2192 or the pointer: values";
  svg.tabIndex = 0;
  svg.setAttribute("role", "slider");
  svg.setAttribute("aria-label", `values of ${figure.getAttribute("aria-label")}`);
  svg.setAttribute("aria-valuemin", panels[0].x[0]);
  svg.setAttribute("aria-valuemax", panels[0].x[1]);
  figure.removeAttribute("role"); // it is no single image any more
  let at = null; // panel, place along and across it in units of the SVG, chosen curve

  svg.addEventListener("pointermove", (event) => {
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const panel = panels.find(({ box }) => inside(place.x, box[0], box[2]) && inside(place.y, box[1], box[3]));
    if (panel) show({ panel, x: place.x, y: place.y });
  });
  svg.addEventListener("keydown", (event) => {
    const { box, curves } = (at ?? { panel: panels[0] }).panel;
    at ??= { panel: panels[0], x: box[0], y: (box[1] + box[3]) / 2 };
    const width = box[2] - box[0];
    const step = width / (event.shiftKey ? 20 : 200);
    const moved = { ArrowRight: at.x + step, ArrowLeft: at.x - step, Home: box[0], End: box[2] }[event.key];
    const turn = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (moved !== undefined) show({ ...at, x: Math.min(Math.max(moved, box[0]), box[2]) });
    else if (turn && curves.length > FEW) {
      const chosen = ((at.chosen ?? nearest(at)?.index ?? 0) + turn + curves.length) % curves.length;
      show({ ...at, chosen });
    } else return;
    event.preventDefault();
  });

  function show(place) {
    at = place;
    marks.replaceChildren();
    told.replaceChildren();
    const beside = panels.filter(({ x }) => x[0] === at.panel.x[0] && x[1] === at.panel.x[1]);
    tell(panels.at(-1).along, valueAt(at.panel, 0, at.x), at.panel.x, "");
    for (const panel of beside) {
      const [left, top, right, bottom] = panel.box;
      const line = marks.appendChild(document.createElementNS(SVG, "line"));
      for (const [name, value] of Object.entries({ x1: at.x, x2: at.x, y1: top, y2: bottom })) line.setAttribute(name, value);
      line.setAttribute("class", "cross");
      for (const curve of curvesToTell(panel)) {
        const crossed = crossings(curve.points, at.x).filter((y) => inside(y, top, bottom));
        for (const y of crossed) dot(at.x, y);
        if (crossed.length) tell({ ...panel.across, ...curve }, crossed.map((y) => valueAt(panel, 1, y)), panel.y, curve.to);
      }
    }
    svg.setAttribute("aria-valuenow", valueAt(at.panel, 0, at.x));
    svg.setAttribute("aria-valuetext", told.textContent);
  }

  function curvesToTell(panel) {
    if (panel.curves.length <= FEW) return panel.curves;
    if (panel !== at.panel) return [];
    const index = at.chosen ?? nearest(at)?.index;
    return index === undefined ? [] : [panel.curves[index]];
  }

  function tell({ name, label, unit }, values, range, to) {
    const text = `${to ? `${label}: ${name}` : label || name} ${[values].flat().map((value) => rounded(value, range)).join(" / ")} ${unit}`;
    if (told.childNodes.length) told.append(" \u00b7 ");
    const part = told.appendChild(document.createElement(to ? "a" : "span"));
    part.textContent = text.trim();
    if (to) part.href = `#${to}`;
  }

  function dot(x, y) {
    const circle = marks.appendChild(document.createElementNS(SVG, "circle"));
    for (const [name, value] of Object.entries({ cx: x, cy: y, r: 2.5, class: "dot" })) circle.setAttribute(name, value);
  }
}

function nearest({ panel, x, y }) {
  let found = null;
  panel.curves.forEach((curve, index) => {
    for (const crossed of crossings(curve.points, x)) {
      const distance = Math.abs(crossed - y);
      if (!found || distance < found.distance) found = { index, distance };
    }
  });
  return found;
}

function pointsOf(path) { // [x, y, begins a new piece] of each point
  const found = [];
  for (const [, command, x, y] of path.getAttribute("d").matchAll(/([ML])\s*(\S+)\s+(\S+)/g)) found.push([+x, +y, command === "M"]);
  return found;
}

function crossings(points, x) { // all places across at a place along, of a curve that may run to and fro
  const found = [];
  for (let i = 1; i < points.length; i++) {
    const [[x0, y0], [x1, y1, begins]] = [points[i - 1], points[i]];
    if (begins || x0 === x1 || !inside(x, Math.min(x0, x1) - ROUNDING, Math.max(x0, x1) + ROUNDING)) continue;
    const y = y0 + (y1 - y0) * Math.min(Math.max((x - x0) / (x1 - x0), 0), 1);
    if (found.every((other) => Math.abs(other - y) > 2 * ROUNDING)) found.push(y);
  }
  return found;
}

function valueAt(panel, direction, place) { // of an axis, from a place in units of the SVG
  const [low, high] = direction ? panel.y : panel.x;
  const [from, to] = direction ? [panel.box[3], panel.box[1]] : [panel.box[0], panel.box[2]];
  const part = (place - from) / (to - from);
  return panel.log[direction] ? low * (high / low) ** part : low + (high - low) * part;
}

function rounded(value, [low, high]) { // to a thousandth of the axis
  const digits = 3 - Math.floor(Math.log10(Math.abs(high - low)));
  return value.toFixed(Math.min(Math.max(digits, 0), 12)).replace("-", "\u2212");
}

function inside(value, low, high) {
  return value >= low && value <= high;
}
