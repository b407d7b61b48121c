// A lattice of weights with break and continue at two depths.
float best = 10.0;
for (int i = -1; i <= 1; ++i) {
  if (p.x > 0.5 && i < 0) continue;
  for (int j = -1; j <= 1; ++j) {
    if (i == j) continue;
    if (best < 0.05) break;
    best = min(best, length(p - 0.45 * vec3(i, j, i * j)) - 0.2);
  }
}
return best;
