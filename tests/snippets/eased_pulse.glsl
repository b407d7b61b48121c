// Eased by smoothstep over a period, then held.
float phase = fract(t / 2500.0);
float size = phase < 0.3 ? smoothstep(0.0, 0.3, phase) : 1.0 - smoothstep(0.6, 1.0, phase);
return length(p) - mix(0.3, 0.7, size);
