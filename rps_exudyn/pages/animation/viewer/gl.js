// What WebGL draws with: one program for bodies, one for lines and arrows of a single colour.

const BODY = {
  vertex: `#version 300 es
    in vec3 place; in vec3 outward;
    uniform float scale; uniform mat3 turn; uniform vec3 origin; uniform mat4 view;
    out vec3 world; out vec3 normal;
    void main() {
      world = turn * (scale * place) + origin;
      normal = turn * outward;
      gl_Position = view * vec4(world, 1.0);
    }`,
  fragment: `#version 300 es
    precision highp float;
    in vec3 world; in vec3 normal;
    uniform vec3 colour; uniform vec3 eye; uniform float alpha; uniform float cut; uniform float sky;
    out vec4 pixel;
    void main() {
      if (world.z > cut) discard;
      vec3 shown = colour;
      if (gl_FrontFacing) {
        vec3 n = normalize(normal), to = normalize(eye - world);
        vec3 sun = normalize(vec3(-0.35, 0.75, 0.6)), fill = normalize(vec3(0.8, -0.35, 0.5));
        float light = 0.34 + 0.14 * n.y + 0.55 * max(dot(n, sun), 0.0) + 0.22 * max(dot(n, fill), 0.0);
        float gloss = pow(max(dot(reflect(-sun, n), to), 0.0), 28.0);
        float rim = pow(1.0 - max(dot(n, to), 0.0), 3.0);
        shown = colour * light + vec3(0.32 * gloss + 0.12 * rim);
      } else {
        float stripe = step(0.5, fract((gl_FragCoord.x - gl_FragCoord.y) / 12.0)); // hatching of the section
        shown = colour * (0.84 + 0.12 * stripe);
      }
      pixel = vec4(pow(shown, vec3(0.85)) * alpha, alpha);
    }`,
};
const PLAIN = {
  vertex: `#version 300 es
    in vec3 place; in vec3 outward; in vec3 tint;
    uniform mat4 view; out vec3 shade;
    void main() {
      float light = length(outward) > 0.0 ? 0.72 + 0.28 * dot(outward, normalize(vec3(-0.35, 0.75, 0.6))) : 1.0;
      shade = tint * light;
      gl_Position = view * vec4(place, 1.0);
    }`,
  fragment: `#version 300 es
    precision highp float;
    in vec3 shade; out vec4 pixel;
    void main() { pixel = vec4(shade, 1.0); }`,
};

function program(gl, sources) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, sources.vertex], [gl.FRAGMENT_SHADER, sources.fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  ["place", "outward", "tint"].forEach((name, number) => gl.bindAttribLocation(made, number, name));
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const at = {}, count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; i++) {
    const name = gl.getActiveUniform(made, i).name;
    at[name] = gl.getUniformLocation(made, name);
  }
  return { made, at };
}

// A part's mesh on the graphics card
function body(gl, part) {
  const vertices = unpacked(part.vertices), normals = unpacked(part.normals), faces = unpacked(part.faces);
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [number, values, kind] of [[0, vertices, gl.SHORT], [1, normals, gl.BYTE]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(number);
    gl.vertexAttribPointer(number, 3, kind, number === 1, 0, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
  gl.bindVertexArray(null);
  const wide = part.faces.kind === "uint16" ? gl.UNSIGNED_SHORT : gl.UNSIGNED_INT;
  return { ...part, array, count: faces.length, wide, scale: part.vertices.scale };
}

// Triangles that change with every frame: place, normal and colour, nine numbers a vertex
function sketch(gl) {
  const array = gl.createVertexArray(), buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  for (let number = 0; number < 3; number++) {
    gl.enableVertexAttribArray(number);
    gl.vertexAttribPointer(number, 3, gl.FLOAT, false, 36, 12 * number);
  }
  gl.bindVertexArray(null);
  return (numbers) => {
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
    gl.drawArrays(gl.TRIANGLES, 0, numbers.length / 9);
  };
}
