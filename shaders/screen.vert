#version 450
// One triangle that covers the screen.

void main() {
  vec2 corner = vec2((gl_VertexIndex & 1) * 4 - 1, (gl_VertexIndex & 2) * 2 - 1);
  gl_Position = vec4(corner, 0.5, 1.0);
}
