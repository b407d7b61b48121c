// A sorting network over an array: the median of five distances.
float d[5] = float[5](length(p) - 0.5, p.x, abs(p.y) - 0.3, p.z + 0.2, length(p.xy) - 0.4);
for (int i = 0; i < 5; ++i) {
  for (int j = 0; j < 4 - i; ++j) {
    if (d[j] > d[j + 1]) {
      float swapped = d[j];
      d[j] = d[j + 1];
      d[j + 1] = swapped;
    }
  }
}
return d[2];
