// A travelling wave: space and time meet inside the sine.
return 0.5 * (p.y - 0.2 * sin(p.x * 6.0 + t * 0.002) * cos(p.z * 5.0 - t * 0.001));
