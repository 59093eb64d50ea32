// The curve under the picture: one signal over the pinion's angle or the time, with a mark at the shown instant.

const SVG = "http://www.w3.org/2000/svg";

function ticks(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough || 1));
  const step = [1, 2, 5, 10].map((each) => each * power).find((each) => each >= rough) || rough || 1;
  const out = [];
  for (let at = Math.ceil(low / step - 1e-9) * step; at <= high + 1e-9 * step; at += step) out.push(at);
  return out;
}

const shortly = (value, digits = 4) => {
  const text = Number(value.toPrecision(digits));
  return (Math.abs(text) < 1e-9 ? "0" : String(text)).replace("-", "−");
};

const ABSCISSA = DATA.over === "time" && TIME
  ? { name: "time", unit: "s", values: TIME }
  : { name: "pinion angle", unit: "°", values: MOTION.pinion_angle.map((angle) => (angle * 180) / Math.PI) };

function makeCurve(holder, onPick) {
  const svg = document.createElementNS(SVG, "svg");
  holder.append(svg);
  let curve = CURVES[0], box = null, mark = null;

  function add(kind, attributes, text) {
    const item = document.createElementNS(SVG, kind);
    for (const [name, value] of Object.entries(attributes)) item.setAttribute(name, value);
    if (text !== undefined) item.textContent = text;
    svg.append(item);
    return item;
  }

  function range(values, least) {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) [low, high] = [Math.min(low, value), Math.max(high, value)];
    const margin = Math.max(0.06 * (high - low), least);
    return [low - margin, high + margin];
  }

  function draw() {
    svg.replaceChildren();
    const width = Math.max(holder.clientWidth, 260), height = 190;
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const x = range(ABSCISSA.values, 0), size = largest(curve.values);
    const y = range(curve.values, Math.max(1e-3 * size, 1e-9));
    x[0] = Math.min(...ABSCISSA.values), x[1] = Math.max(...ABSCISSA.values);
    const [left, right, top, bottom] = [58, width - 10, 22, height - 32];
    const toX = (value) => left + ((value - x[0]) / (x[1] - x[0] || 1)) * (right - left);
    const toY = (value) => bottom - ((value - y[0]) / (y[1] - y[0] || 1)) * (bottom - top);
    for (const at of ticks(...y, 4)) {
      add("line", { x1: left, x2: right, y1: toY(at), y2: toY(at), class: "grid" });
      add("text", { x: left - 6, y: toY(at) + 4, "text-anchor": "end" }, shortly(at));
    }
    for (const at of ticks(...x, Math.max(3, Math.floor(width / 90)))) {
      add("line", { x1: toX(at), x2: toX(at), y1: bottom, y2: bottom + 4, class: "grid" });
      add("text", { x: toX(at), y: bottom + 16, "text-anchor": "middle" }, shortly(at));
    }
    add("text", { x: right, y: height - 3, "text-anchor": "end" }, `${ABSCISSA.name} [${ABSCISSA.unit}]`);
    add("text", { x: 4, y: 13 }, `${curve.name}${curve.unit ? ` [${curve.unit}]` : ""}${y[0] > 0 ? "  (axis does not start at 0)" : ""}`);
    const points = Array.from(curve.values, (value, k) => `${toX(ABSCISSA.values[k]).toFixed(1)},${toY(value).toFixed(1)}`);
    add("polyline", { points: points.join(" "), class: "curve" });
    mark = [add("line", { y1: top, y2: bottom, class: "cursor" }), add("circle", { r: 4.5, class: "dot" })];
    box = { toX, toY, left, right, width };
  }

  function show(frame) {
    if (!box) draw();
    const at = box.toX(ABSCISSA.values[frame]);
    mark[0].setAttribute("x1", at);
    mark[0].setAttribute("x2", at);
    mark[1].setAttribute("cx", at);
    mark[1].setAttribute("cy", box.toY(curve.values[frame]));
  }

  function pick(event) {
    const seen = svg.getBoundingClientRect(), at = ((event.clientX - seen.left) / seen.width) * box.width;
    let best = 0;
    ABSCISSA.values.forEach((value, k) => {
      if (Math.abs(box.toX(value) - at) < Math.abs(box.toX(ABSCISSA.values[best]) - at)) best = k;
    });
    onPick(best);
  }

  svg.addEventListener("pointerdown", (event) => {
    svg.setPointerCapture(event.pointerId);
    pick(event);
  });
  svg.addEventListener("pointermove", (event) => event.buttons && pick(event));
  return {
    show,
    resize: draw,
    choose(signal) {
      curve = CURVES.find((each) => each.signal === signal);
      draw();
    },
    reading: (frame) => `${curve.name} ${shortly(curve.values[frame], 3)} ${curve.unit}`,
  };
}
