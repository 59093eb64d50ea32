// Controls: what the reader does changes the state, and each change is drawn with the next frame of the screen.

const element = (id) => document.getElementById(id);
const canvas = element("view"), slider = element("instant");

const camera = (name) => ({ ...DATA.views[name], target: [...DATA.views[name].target] });

const state = {
  frame: 0, factors: DATA.factors.length - 1, explode: 0, section: true, glass: false, lines: true, forces: true,
  playing: false, speed: 1, camera: camera("gear"),
};
window.rpsView = { get: () => ({ ...state }), set: (earlier) => { Object.assign(state, { camera: earlier.camera, explode: earlier.explode }); refresh(); } };
let wanted = false, last = 0, passed = 0;
let paint = null;
try {
  paint = makeScene(canvas);
} catch (error) {
  console.warn(String(error)); // a graphics driver that cannot: the still is shown
}
const curve = makeCurve(element("curve"), (frame) => go(frame));
document.body.classList.toggle("still", !paint);

function refresh() {
  if (wanted) return;
  wanted = true;
  requestAnimationFrame((now) => {
    wanted = false;
    if (state.playing) advance(now);
    if (paint) paint(state);
    tell();
    if (state.playing) refresh();
  });
}

const WHOLE = 8000; // playing a record takes this long at speed 1 [ms]
function advance(now) {
  passed += last ? Math.min(now - last, 200) * state.speed : 0;
  last = now;
  state.frame = Math.floor((passed / WHOLE) * DATA.frames) % DATA.frames;
}

function go(frame) {
  state.frame = Math.min(Math.max(frame, 0), DATA.frames - 1);
  passed = (state.frame / DATA.frames) * WHOLE;
  refresh();
}

function play(on) {
  state.playing = on;
  last = 0;
  element("play").textContent = on ? "❚❚ pause" : "▶ play";
  refresh();
}

function tell() {
  const degrees = (MOTION.pinion_angle[state.frame] * 180) / Math.PI;
  const when = `${TIME ? `${shortly(TIME[state.frame])} s, ` : ""}pinion at ${shortly(Math.round(degrees * 10) / 10)}°`;
  const exact = DATA.factors[state.factors].every((factor) => factor === 1);
  element("magnified").textContent = exact ? "" : `deflections: ${element("factors").selectedOptions[0].text}`;
  slider.value = state.frame;
  slider.setAttribute("aria-valuetext", `${when}, ${curve.reading(state.frame)}`);
  element("reading").textContent = `${when} · ${curve.reading(state.frame)}`;
  curve.show(state.frame);
  for (const arrow of DATA.arrows) {
    element(`force-${arrow.signal}`).textContent = `${shortly(ALL.get(arrow.signal)[state.frame], 3)} ${arrow.unit}`;
  }
}

// --- turning, moving nearer ------------------------------------------------------------------------
const touches = new Map();
const spread = () => {
  const [a, b] = [...touches.values()];
  return Math.hypot(a.x - b.x, a.y - b.y);
};

function turnBy(x, y) {
  state.camera.azimuth += x;
  state.camera.elevation = Math.min(Math.max(state.camera.elevation + y, -1.5), 1.5);
  refresh();
}

function nearer(factor) {
  state.camera.distance = Math.min(Math.max(state.camera.distance * factor, 3 * DATA.size), 200 * DATA.size);
  refresh();
}

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
});
canvas.addEventListener("pointermove", (event) => {
  const before = touches.get(event.pointerId);
  if (!before) return;
  const apart = touches.size === 2 ? spread() : 0;
  touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
  if (apart) nearer(apart / (spread() || 1));
  else turnBy(0.008 * (event.clientX - before.x), 0.008 * (event.clientY - before.y));
});
for (const end of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(end, (event) => touches.delete(event.pointerId));
}
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  nearer(Math.exp(0.001 * event.deltaY));
}, { passive: false });

const KEYS = {
  ArrowLeft: () => turnBy(-0.08, 0), ArrowRight: () => turnBy(0.08, 0),
  ArrowUp: () => turnBy(0, -0.08), ArrowDown: () => turnBy(0, 0.08),
  "+": () => nearer(0.9), "=": () => nearer(0.9), "-": () => nearer(1.1),
  " ": () => play(!state.playing), ",": () => go(state.frame - 1), ".": () => go(state.frame + 1),
};
canvas.addEventListener("keydown", (event) => {
  if (!KEYS[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  KEYS[event.key]();
});

// --- controls ------------------------------------------------------------------------------------------
slider.max = DATA.frames - 1;
slider.addEventListener("input", () => {
  play(false);
  go(Number(slider.value));
});
element("play").addEventListener("click", () => play(!state.playing));
element("speed").addEventListener("change", (event) => { state.speed = Number(event.target.value); });
element("signal").addEventListener("change", (event) => { curve.choose(event.target.value); refresh(); });
element("factors").addEventListener("change", (event) => { state.factors = Number(event.target.value); refresh(); });
element("explode").addEventListener("input", (event) => { state.explode = Number(event.target.value) / 100; refresh(); });
for (const name of ["section", "glass", "lines", "forces"]) {
  element(name).addEventListener("change", (event) => { state[name] = event.target.checked; refresh(); });
}
for (const button of document.querySelectorAll("[data-view]")) {
  button.addEventListener("click", () => {
    state.camera = camera(button.dataset.view);
    refresh();
  });
}
window.addEventListener("resize", () => { curve.resize(); refresh(); });
state.factors = Number(element("factors").value);
refresh();
