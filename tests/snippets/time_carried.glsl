// A position advanced step by step by an amount that depends on time alone.
vec3 q = p;
float a = 0.2 * sin(t * 0.0005);
for (int i = 0; i < 4; ++i) {
  q.xz = vec2(q.x - a * q.z, q.z + a * q.x);
  q.y += 0.05 * a;
}
return 0.7 * (length(q - vec3(0.3, 0.0, 0.0)) - 0.35);
