// Sierpinski tetrahedron by folding, six rounds.
float scale = 1.0;
for (int i = 0; i < 6; ++i) {
  if (p.x + p.y < 0.0) p.xy = -p.yx;
  if (p.x + p.z < 0.0) p.xz = -p.zx;
  if (p.y + p.z < 0.0) p.zy = -p.yz;
  p = 2.0 * p - 0.8;
  scale *= 2.0;
}
return (length(p) - 1.2) / scale;
