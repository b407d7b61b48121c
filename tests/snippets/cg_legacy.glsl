// Spellings of Cg, as older files have them.
float3 q = frac(p * 0.5 + 0.5) * 2.0 - 1.0;
float s = saturate(lerp(0.2, 0.8, q.x * 0.5 + 0.5));
float2x2 m = float2x2(0.8, 0.6, -0.6, 0.8);
float2 r = mul(m, q.xy);
return length(float3(r, q.z)) - 0.4 - 0.2 * s + 0.05 * fmod(2.5, 1.0) + 0.01 * atan2(q.y, q.x + 2.0) * rsqrt(1.5);
