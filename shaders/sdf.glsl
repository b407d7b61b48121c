// The library of distance functions: `#include <sdf>` in a function or in FUNCTIONS (spec/snippets.md).
//
// p is a point, the shape stands at the origin; lengths are in the units of p, angles in radians; y is the axis of what
// has one. Negative inside.
//   exact    the distance to the surface, everywhere
//   bound    never more than the distance, zero on the surface alone: safe to step by, but smaller than it could be
//   L        the Lipschitz constant: how much faster than a distance the value can change
//
// Sources: Hart 1996, "Sphere tracing" (primitives, domain operations and their bounds); Quilez, "Distance functions"
// and "Smooth minimum" (catalogue of exact forms); Ricci 1973 and Blinn 1982 (blending); Perlin 2002 (fade curve);
// Jarzynski and Olano 2020, "Hash functions for GPU rendering" (pcg3d). The code is written for this project.

// ---- shapes: exact, L = 1, unless they say otherwise ----

/// Ball of radius r.
float sd_sphere(vec3 p, float r) { return length(p) - r; }

/// The half space below the plane dot(x, n) = d; n is a unit vector.
float sd_plane(vec3 p, vec3 n, float d) { return dot(p, n) - d; }

/// Box of half edges b.
float sd_box(vec3 p, vec3 b) {
  vec3 q = abs(p) - b;
  return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

/// Box of half edges b whose edges are rounded by radius r <= the least of b.
float sd_round_box(vec3 p, vec3 b, float r) { return sd_box(p, b - r) - r; }

/// Torus around y: the tube of radius r <= R stands at distance R from the axis.
float sd_torus(vec3 p, float R, float r) { return length(vec2(length(p.xz) - R, p.y)) - r; }

/// All points within r of the segment from a to b.
float sd_capsule(vec3 p, vec3 a, vec3 b, float r) {
  vec3 along = b - a;
  float s = clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return distance(p, a + s * along) - r;
}

/// Cylinder around y, from y = -h to h, of radius r.
float sd_cylinder(vec3 p, float h, float r) {
  vec2 q = vec2(length(p.xz) - r, abs(p.y) - h);
  return length(max(q, 0.0)) + min(max(q.x, q.y), 0.0);
}

/// Cone cut off around y: radius r1 at y = -h, r2 at y = h.
float sd_capped_cone(vec3 p, float h, float r1, float r2) {
  vec2 q = vec2(length(p.xz), p.y);
  vec2 side = vec2(r2 - r1, 2.0 * h);
  vec2 from_corner = q - vec2(r1, -h);
  vec2 to_side = from_corner - side * clamp(dot(from_corner, side) / dot(side, side), 0.0, 1.0);
  vec2 to_cap = vec2(max(q.x - (q.y < 0.0 ? r1 : r2), 0.0), abs(q.y) - h);
  bool inside = abs(q.y) < h && from_corner.x * side.y < from_corner.y * side.x;
  float d = sqrt(min(dot(to_side, to_side), dot(to_cap, to_cap)));
  return inside ? -d : d;
}

/// Cone around y: radius r at y = -h, its tip at y = h.
float sd_cone(vec3 p, float h, float r) { return sd_capped_cone(p, h, r, 0.0); }

/// The hull of two balls on the y axis: radius r1 at the origin, r2 at y = h; h > |r1 - r2|.
float sd_round_cone(vec3 p, float h, float r1, float r2) {
  vec2 q = vec2(length(p.xz), p.y);
  float s = (r1 - r2) / h;
  vec2 n = vec2(sqrt(1.0 - s * s), s);
  float along = n.x * q.y - n.y * q.x;
  if (along < 0.0) return length(q) - r1;
  if (along > n.x * h) return length(q - vec2(0.0, h)) - r2;
  return dot(q, n) - r1;
}

/// Octahedron with corners at distance s on the axes.
float sd_octahedron(vec3 p, float s) {
  vec3 a = abs(p);
  float m = a.x + a.y + a.z - s;
  vec3 foot = a - m / 3.0;
  if (min(foot.x, min(foot.y, foot.z)) >= 0.0) return m * 0.57735026919;
  vec3 e = foot.x < 0.0 ? a.xyz : foot.y < 0.0 ? a.yzx : a.zxy;
  float k = clamp(0.5 * (e.y - e.z + s), 0.0, s);
  return length(e - vec3(0.0, k, s - k));
}

/// Prism around y over a regular hexagon whose sides have distance r from the axis, from y = -h to h.
float sd_hex_prism(vec3 p, float r, float h) {
  vec2 q = abs(p.xz);
  vec2 n = vec2(-0.86602540378, 0.5);
  q -= 2.0 * min(dot(n, q), 0.0) * n;
  q -= vec2(clamp(q.x, -0.57735026919 * r, 0.57735026919 * r), r);
  vec2 d = vec2(q.y < 0.0 ? -length(q) : length(q), abs(p.y) - h);
  return length(max(d, 0.0)) + min(max(d.x, d.y), 0.0);
}

/// Ellipsoid of half axes r. Bound, L = 1: exact for a ball, the smaller the flatter it is.
float sd_ellipsoid(vec3 p, vec3 r) { return (length(p / r) - 1.0) * min(r.x, min(r.y, r.z)); }

/// Regular tetrahedron around the origin whose faces have distance r from it. Bound, L = 1: exact inside.
float sd_tetrahedron(vec3 p, float r) {
  float d = max(max(p.x + p.y + p.z, p.x - p.y - p.z), max(p.y - p.x - p.z, p.z - p.x - p.y));
  return d * 0.57735026919 - r;
}

/// Sheet of thickness 2 r along a gyroid of k waves in 2 pi. Bound, L = 1: the gradient of a gyroid is at most
/// sqrt(6) k.
float sd_gyroid(vec3 p, float k, float r) {
  return abs(dot(sin(k * p), cos(k * p.yzx))) / (2.44948974278 * abs(k)) - r;
}

// ---- operations on distances: L is the larger one of a and b ----

/// Exact outside where a and b are, bound inside.
float op_union(float a, float b) { return min(a, b); }

/// Exact inside where a and b are, bound outside.
float op_intersection(float a, float b) { return max(a, b); }

/// a without b. Bound.
float op_difference(float a, float b) { return max(a, -b); }

/// Union whose seam is filled where |a - b| < k (quadratic; k / 4 deep). Bound.
float op_smooth_union(float a, float b, float k) {
  float h = max(k - abs(a - b), 0.0);
  return min(a, b) - h * h / (4.0 * k);
}

/// Bound.
float op_smooth_intersection(float a, float b, float k) { return -op_smooth_union(-a, -b, k); }

/// a without b, the edge rounded. Bound.
float op_smooth_difference(float a, float b, float k) { return -op_smooth_union(-a, b, k); }

/// Union by the logarithm of a sum of exponentials: smooth everywhere, k log 2 deep; the order of many does not
/// matter. Bound.
float op_smooth_union_exp(float a, float b, float k) { return min(a, b) - k * log(1.0 + exp(-abs(a - b) / k)); }

/// All points within r of the shape. As exact as d outside, bound inside.
float op_round(float d, float r) { return d - r; }

/// The shell of thickness 2 r around the surface. Bound; exact outside of the shell where d is.
float op_onion(float d, float r) { return abs(d) - r; }

// ---- operations on the point: call the shape with the result ----

/// Turns the shape around an axis through the origin, right-handed. Exact, L = 1.
vec3 op_rotate_x(vec3 p, float angle) {
  float c = cos(angle), s = sin(angle);
  return vec3(p.x, c * p.y + s * p.z, c * p.z - s * p.y);
}
vec3 op_rotate_y(vec3 p, float angle) {
  float c = cos(angle), s = sin(angle);
  return vec3(c * p.x - s * p.z, p.y, c * p.z + s * p.x);
}
vec3 op_rotate_z(vec3 p, float angle) {
  float c = cos(angle), s = sin(angle);
  return vec3(c * p.x + s * p.y, c * p.y - s * p.x, p.z);
}

/// The same around a unit vector.
vec3 op_rotate(vec3 p, vec3 axis, float angle) {
  float c = cos(angle);
  return c * p - sin(angle) * cross(axis, p) + (1.0 - c) * dot(axis, p) * axis;
}

/// Cuts the shape at the origin and draws it apart by h on each side of each axis. L = 1; exact outside.
vec3 op_elongate(vec3 p, vec3 h) { return p - clamp(p, -h, h); }

/// Repeats the shape with the period c. L = 1 where the shape is symmetric and stays in its cell, |x| <= c / 2; else
/// the value jumps at the borders of cells.
vec3 op_repeat(vec3 p, vec3 c) { return p - c * floor(p / c + 0.5); }

/// The same, n times to each side of the origin: 2 n + 1 in all.
vec3 op_repeat_limited(vec3 p, vec3 c, vec3 n) { return p - c * clamp(floor(p / c + 0.5), -n, n); }

/// Repeats what stands around the x axis n times around the y axis. L = 1 under the same condition.
vec3 op_repeat_polar(vec3 p, float n) {
  float sector = 6.28318530718 / n;
  float angle = sector * floor(atan(p.z, p.x) / sector + 0.5);
  return op_rotate_y(p, -angle);
}

/// Twists the shape around y by k radians a unit. Not a bound: divide the distance by op_twist_bound(k, r).
vec3 op_twist(vec3 p, float k) { return op_rotate_y(p, k * p.y); }

/// L of op_twist up to the distance r from the axis: the larger singular value of a shear.
float op_twist_bound(float k, float r) { return 0.5 * (abs(k) * r + sqrt(k * k * r * r + 4.0)); }

/// Bends the x axis in the xy plane by k radians a unit. Not a bound: divide the distance by op_bend_bound(k, r).
vec3 op_bend(vec3 p, float k) { return op_rotate_z(p, k * p.x); }

/// L of op_bend up to the distance r from the z axis.
float op_bend_bound(float k, float r) { return 1.0 + abs(k) * r; }

/// Noise between -1 and 1 with a period of 1, the same on every device. Twice differentiable, L = 6.5:
/// (d + a * op_noise(k * p)) / (1.0 + 6.5 * a * k) is a bound.
float op_noise(vec3 p) {
  vec3 cell = floor(p);
  vec3 x = p - cell;
  vec3 w = x * x * x * (x * (x * 6.0 - 15.0) + 10.0);
  float sum = 0.0;
  for (int i = 0; i < 8; ++i) {
    ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
    uvec3 v = uvec3(ivec3(cell) + corner) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    vec3 share = mix(1.0 - w, w, vec3(corner));
    sum += share.x * share.y * share.z * (float(v.x >> 8u) * (2.0 / 16777215.0) - 1.0);
  }
  return sum;
}
