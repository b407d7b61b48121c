// Time through floor, mod and min: a triangle wave, sharp at its turns.
float phase = abs(mod(t, 2000.0) - 1000.0) / 1000.0;
float height = min(phase, 0.8) - floor(t / 4000.0) * 0.0;
return p.y - height + 0.5;
