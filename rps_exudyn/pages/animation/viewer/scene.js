// The scene: eye, bodies at one instant, what is drawn over them.

const eyeOf = ({ azimuth, elevation, distance, target }) => {
  const flat = Math.cos(elevation);
  const to = [-flat * Math.sin(azimuth), Math.sin(elevation), flat * Math.cos(azimuth)];
  return { to, place: plus(target, scaled(distance, to)) };
};

// View and perspective in one matrix, column by column as WebGL wants it
function viewMatrix(camera, aspect) {
  const { to, place } = eyeOf(camera);
  const right = [Math.cos(camera.azimuth), 0, Math.sin(camera.azimuth)], up = crossed(to, right);
  const tall = 1 / Math.tan(0.25 / Math.min(1, aspect)), wide = tall / aspect;
  const near = Math.max(0.05 * camera.distance, camera.distance - 0.8), far = camera.distance + 0.9;
  const [c, d] = [-(far + near) / (far - near), (-2 * far * near) / (far - near)];
  const dot = (a) => -(a[0] * place[0] + a[1] * place[1] + a[2] * place[2]);
  const out = [];
  for (let k = 0; k < 3; k++) out.push(wide * right[k], tall * up[k], c * to[k], -to[k]);
  return [...out, wide * dot(right), tall * dot(up), c * dot(to) + d, -dot(to)];
}

function makeScene(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: true });
  if (!gl) return null;
  const solid = program(gl, BODY), plain = program(gl, PLAIN), draw = sketch(gl);
  const bodies = DATA.parts.map((part) => body(gl, part));
  gl.enable(gl.DEPTH_TEST);

  function drawBody(item, pose, away, state, alpha) {
    const [turn, origin] = pose[item.name], { at } = solid;
    gl.uniform1f(at.scale, item.scale);
    gl.uniformMatrix3fv(at.turn, true, turn);
    gl.uniform3fv(at.origin, plus(origin, away[item.name]));
    gl.uniform3fv(at.colour, item.colour);
    gl.uniform1f(at.alpha, alpha);
    gl.uniform1f(at.cut, item.name === "pinion" ? state.camera.shaftCut : state.section && item.sectioned ? 0 : 1e3);
    gl.bindVertexArray(item.array);
    gl.drawElements(gl.TRIANGLES, item.count, item.wide, 0);
  }

  return function drawScene(state) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((size) => Math.max(1, Math.round(size * ratio)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const pose = poses(state.frame, DATA.factors[state.factors]);
    const away = Object.fromEntries(DATA.parts.map((part) => [part.name, scaled(state.explode, part.away)]));
    const view = viewMatrix(state.camera, width / height), { place } = eyeOf(state.camera);
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(solid.made);
    gl.uniformMatrix4fv(solid.at.view, false, view);
    gl.uniform3fv(solid.at.eye, place);
    const glassy = (item) => state.glass && item.name === "rack";
    for (const item of bodies) if (!glassy(item)) drawBody(item, pose, away, state, 1);
    for (const item of bodies.filter(glassy)) { // its depth first, then one layer of it
      gl.colorMask(false, false, false, false);
      drawBody(item, pose, away, state, 1);
      gl.colorMask(true, true, true, true);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthFunc(gl.LEQUAL);
      drawBody(item, pose, away, state, 0.28);
      gl.depthFunc(gl.LESS);
      gl.disable(gl.BLEND);
    }
    gl.useProgram(plain.made);
    gl.uniformMatrix4fv(plain.at.view, false, view);
    gl.clear(gl.DEPTH_BUFFER_BIT); // what follows is seen through the bodies
    if (state.forces) draw([...forceArrows(state.frame, pose, away), ...torqueArrow(state.frame, pose, away)]);
    if (state.lines && !state.explode) {
      gl.clear(gl.DEPTH_BUFFER_BIT);
      draw(ribbons(state.frame, pose, place, (0.005 * state.camera.distance)));
    }
    gl.bindVertexArray(null);
  };
}
