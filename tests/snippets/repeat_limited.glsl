// Limited repetition (Quilez): round and clamp.
vec3 cell = clamp(round(p / 0.4), -1.0, 1.0);
return length(p - 0.4 * cell) - 0.15;
