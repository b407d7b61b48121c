// Rodrigues' rotation as a matrix, built in a helper.
mat3 rotation(vec3 axis, float angle) {
  float s = sin(angle), c = cos(angle), k = 1.0 - c;
  return mat3(c + axis.x * axis.x * k, axis.y * axis.x * k + axis.z * s, axis.z * axis.x * k - axis.y * s,
              axis.x * axis.y * k - axis.z * s, c + axis.y * axis.y * k, axis.z * axis.y * k + axis.x * s,
              axis.x * axis.z * k + axis.y * s, axis.y * axis.z * k - axis.x * s, c + axis.z * axis.z * k);
}
float box(vec3 q, vec3 half_size) {
  vec3 d = abs(q) - half_size;
  return length(max(d, 0.0)) + min(max(d.x, max(d.y, d.z)), 0.0);
}
// ---- body
mat3 r = rotation(normalize(vec3(1.0, 1.0, 0.5)), 0.0007 * t);
return box(transpose(r) * p, vec3(0.5, 0.3, 0.2));
