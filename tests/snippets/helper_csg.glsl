// A part made of helpers that call helpers, with out parameters, overloads and a struct.
struct Shape {
  vec3 centre;
  float size;
};
float sphere(vec3 q, float r) { return length(q) - r; }
float sphere(Shape s, vec3 q) { return sphere(q - s.centre, s.size); }
float box(vec3 q, vec3 b) {
  vec3 d = abs(q) - b;
  return length(max(d, 0.0)) + min(max(d.x, max(d.y, d.z)), 0.0);
}
float cut(float a, float b) { return max(a, -b); }
void place(in vec3 q, inout vec3 moved, out float scale) {
  moved = q * 1.25 - moved;
  scale = 0.8;
}
// ---- body
vec3 q = vec3(0.1, 0.0, -0.1);
float scale;
place(p, q, scale);
Shape ball = Shape(vec3(0.3), 0.55);
return scale * min(cut(box(q, vec3(0.6)), sphere(ball, q)), sphere(q + 0.7, 0.2));
