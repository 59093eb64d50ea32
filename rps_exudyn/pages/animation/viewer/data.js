"use strict";
// Numbers of the page: arrays that animation/encode.py has written, and small matrices (row by row).

const KINDS = {
  int8: Int8Array, uint8: Uint8Array, int16: Int16Array, uint16: Uint16Array, uint32: Uint32Array, float32: Float32Array,
};

function unpacked(item) {
  const bytes = Uint8Array.from(atob(item.data), (letter) => letter.charCodeAt(0));
  return new KINDS[item.kind](bytes.buffer);
}

const times = (m, x) => [0, 3, 6].map((i) => m[i] * x[0] + m[i + 1] * x[1] + m[i + 2] * x[2]);
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const scaled = (f, a) => [f * a[0], f * a[1], f * a[2]];
const crossed = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => scaled(1 / (Math.hypot(...a) || 1), a);

function product(a, b) {
  const c = [];
  for (let i = 0; i < 9; i++) {
    const row = 3 * Math.floor(i / 3), column = i % 3;
    c.push(a[row] * b[column] + a[row + 1] * b[column + 3] + a[row + 2] * b[column + 6]);
  }
  return c;
}

// Rotation Rx(a) Ry(b) Rz(c), as forces/rigid_motion.py
function rotation(a, b, c) {
  const [ca, sa, cb, sb, cc, sc] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b), Math.cos(c), Math.sin(c)];
  return [
    cb * cc, -cb * sc, sb,
    ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -sa * cb,
    sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb,
  ];
}

const DATA = JSON.parse(document.getElementById("data").textContent);
const MOTION = Object.fromEntries(Object.entries(DATA.motion).map(([name, item]) => [name, unpacked(item)]));
const TIME = DATA.time ? unpacked(DATA.time) : null;
const CURVES = DATA.curves.map((curve) => ({ ...curve, values: unpacked(curve.values) }));
const UPRIGHT = [1, 0, 0, 0, 1, 0, 0, 0, 1];

// A deflection, magnified about its mean over the record
function magnified(name, frame, factor) {
  return DATA.means[name] + factor * (MOTION[name][frame] - DATA.means[name]);
}

// Rotation and origin of every part at one instant, as animation/motion.py has them
function poses(frame, factors) {
  const [lifts, tilts] = factors, angle = MOTION.pinion_angle[frame];
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const turn = rotation(...["rack_roll", "rack_yaw", "rack_pitch"].map((name) => magnified(name, frame, tilts)));
  const x = MOTION.rack_displacement[frame], axis = DATA.axis;
  const y = magnified("rack_y", frame, lifts), z = magnified("rack_z", frame, lifts);
  const behind = [0, axis + magnified("plunger_displacement", frame, lifts), 0];
  return {
    pinion: [product(DATA.frame, [c, s, 0, -s, c, 0, 0, 0, 1]), DATA.origin],
    rack: [turn, [x, axis + y + (x * turn[3]) / turn[0], z + (x * turn[6]) / turn[0]]],
    plunger: [UPRIGHT, behind],
    spring: [UPRIGHT, behind],
    yokenut: [UPRIGHT, [0, axis, 0]],
    bush: [UPRIGHT, [DATA.bushPlace, axis, 0]],
  };
}
