// Triangles of what is drawn over the bodies: lines of contact by their load, forces and the torque as arrows.

const LINES = DATA.lines && {
  stations: DATA.lines.stations,
  begins: unpacked(DATA.lines.begins),
  side: unpacked(DATA.lines.side),
  ends: unpacked(DATA.lines.ends),
  load: unpacked(DATA.lines.load),
  scale: DATA.lines.ends.scale,
};
const ALL = new Map(CURVES.map((curve) => [curve.signal, curve.values]));
const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
const STRONGEST = Math.max(...DATA.arrows.map((arrow) => largest(ALL.get(arrow.signal) || [0])), 1e-9);
const LONGEST = 2.6 * DATA.size; // of the arrow of the strongest force

// Colours of a load from 0 to 1: dark violet over red to yellow, rising in brightness
const RAMP = [[0.27, 0.0, 0.42], [0.62, 0.1, 0.45], [0.89, 0.29, 0.25], [0.98, 0.58, 0.04], [0.98, 0.95, 0.45]];
function ramp(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1), i = Math.min(Math.floor(at), RAMP.length - 2);
  return RAMP[i].map((low, k) => low + (at - i) * (RAMP[i + 1][k] - low));
}
const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

function vertex(out, place, normal, colour) {
  out.push(...place, ...normal, ...colour);
}

// Ribbons along the lines, `width` wide [m] and turned to the eye
function ribbons(frame, pose, eye, width) {
  const out = [], [turn, origin] = pose.pinion, n = LINES ? LINES.stations : 0;
  if (!LINES) return out;
  for (let line = LINES.begins[frame]; line < LINES.begins[frame + 1]; line++) {
    const [a, b] = [0, 3].map((at) => {
      const ends = LINES.ends.subarray(6 * line + at, 6 * line + at + 3);
      return plus(times(turn, scaled(LINES.scale, Array.from(ends))), origin);
    });
    const along = plus(b, scaled(-1, a));
    const across = scaled(width / 2, unit(crossed(along, plus(eye, scaled(-1, a)))));
    for (let i = 0; i + 1 < n; i++) {
      const [p, q] = [i, i + 1].map((k) => plus(a, scaled(k / (n - 1), along)));
      const [c, d] = [i, i + 1].map((k) => ramp(LINES.load[n * line + k] / 255));
      const corners = [[p, 1, c], [p, -1, c], [q, 1, d], [q, 1, d], [p, -1, c], [q, -1, d]];
      for (const [place, side, colour] of corners) vertex(out, plus(place, scaled(side, across)), [0, 0, 0], colour);
    }
  }
  return out;
}

// A round shaft or, with `end` 0, a cone between two points
function cone(out, from, to, radius, end, colour) {
  const axis = unit(plus(to, scaled(-1, from)));
  const u = unit(crossed(axis, Math.abs(axis[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0])), v = crossed(axis, u);
  const around = (k) => plus(scaled(Math.cos(k * 0.5236), u), scaled(Math.sin(k * 0.5236), v));
  for (let k = 0; k < 12; k++) {
    const [n, m] = [around(k), around(k + 1)];
    const [a, b] = [plus(from, scaled(radius, n)), plus(from, scaled(radius, m))];
    const [c, d] = [plus(to, scaled(end, n)), plus(to, scaled(end, m))];
    for (const [place, normal] of [[a, n], [b, m], [c, n], [c, n], [b, m], [d, m]]) vertex(out, place, normal, colour);
    for (const place of [from, b, a]) vertex(out, place, scaled(-1, axis), colour);
  }
}

// Arrows whose heads are where the forces act; as long as the force is large
function forceArrows(frame, pose, away) {
  const out = [], thick = 0.1 * DATA.size;
  for (const arrow of DATA.arrows) {
    const force = (ALL.get(arrow.signal) || [])[frame] || 0;
    const length = (LONGEST * force) / STRONGEST;
    if (Math.abs(length) < 0.02 * LONGEST) continue;
    const head = actsAt(arrow, frame, pose, away), way = scaled(Math.sign(length), unit(arrow.direction));
    const tip = Math.min(3.2 * thick, 0.6 * Math.abs(length)), colour = rgb(arrow.colour);
    const neck = plus(head, scaled(-tip, way)), tail = plus(head, scaled(-Math.abs(length), way));
    cone(out, tail, neck, 0.5 * thick, 0.5 * thick, colour);
    cone(out, neck, head, 1.3 * thick, 0, colour);
  }
  return out;
}

// Point at which a force acts: forces of the teeth in the middle of their lines, by load
function actsAt(arrow, frame, pose, away) {
  if (arrow.part !== "mesh") {
    const [turn, origin] = pose[arrow.part];
    return plus(plus(times(turn, arrow.point), origin), away[arrow.part]);
  }
  const side = arrow.signal.endsWith("drive") ? -1 : 1;
  let sum = 0, place = [0, 0, 0];
  const [turn, origin] = pose.pinion;
  for (let line = LINES ? LINES.begins[frame] : 0; LINES && line < LINES.begins[frame + 1]; line++) {
    if (LINES.side[line] !== side) continue;
    for (let k = 0; k < LINES.stations; k++) {
      const load = LINES.load[LINES.stations * line + k], share = k / (LINES.stations - 1);
      const ends = LINES.ends.subarray(6 * line, 6 * line + 6);
      const point = [0, 1, 2].map((i) => LINES.scale * ((1 - share) * ends[i] + share * ends[i + 3]));
      place = plus(place, scaled(load, point));
      sum += load;
    }
  }
  if (sum) return plus(plus(times(turn, scaled(1 / sum, place)), origin), away.pinion);
  return plus(plus([0, arrow.point[1], 0], [0, DATA.axis, 0]), away.rack);
}

// The torque as an arrow bent around the shaft, in the sense in which it turns the pinion
function torqueArrow(frame, pose, away) {
  const torque = ALL.get("pinion_torque"), out = [];
  if (!torque) return out;
  const share = torque[frame] / (largest(torque) || 1), [axial, radius] = DATA.torquePlace;
  if (Math.abs(share) < 0.02) return out;
  const [, origin] = pose.pinion, steps = 24, colour = rgb("#c2255c"), thick = 0.09 * DATA.size;
  const at = (turn) => {
    const local = [radius * Math.sin(turn), radius * Math.cos(turn), axial];
    return plus(plus(times(DATA.frame, local), origin), away.pinion);
  };
  const sweep = 5.2 * share;
  for (let i = 0; i < steps; i++) {
    cone(out, at((sweep * i) / steps), at((sweep * (i + 1)) / steps), 0.5 * thick, 0.5 * thick, colour);
  }
  cone(out, at(sweep), at(sweep + (Math.sign(share) * 3.6 * thick) / radius), 1.4 * thick, 0, colour);
  return out;
}
