#pragma once
/// Plane and space vectors of the oracle. Everything is computed in `Real` (80-bit on x86), so that rounding of the oracle is negligible
/// against that of the production kernels, whatever cancels: joint and tip depths are micrometres between lengths of up to metres.

#include <cmath>

namespace cvtflow::oracle {

using Real = long double;

struct Vec2 {
    Real x = 0.0L;
    Real y = 0.0L;
};

inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
inline Vec2 operator*(Real s, Vec2 a) { return {s * a.x, s * a.y}; }
inline Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
inline Vec2& operator+=(Vec2& a, Vec2 b) { return a = a + b; }
inline Real dot(Vec2 a, Vec2 b) { return a.x * b.x + a.y * b.y; }
/// z component of the cross product.
inline Real cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
/// k × a: a quarter turn to the left.
inline Vec2 left_of(Vec2 a) { return {-a.y, a.x}; }
inline Real norm(Vec2 a) { return std::sqrt(dot(a, a)); }
inline Vec2 unit(Vec2 a) { return (1.0L / norm(a)) * a; }

struct Vec3 {
    Real x = 0.0L;
    Real y = 0.0L;
    Real z = 0.0L;
};

inline Vec3 in_space(Vec2 plane, Real z) { return {plane.x, plane.y, z}; }
inline Vec2 in_plane(Vec3 a) { return {a.x, a.y}; }
inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(Real s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
inline Real dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Real norm(Vec3 a) { return std::sqrt(dot(a, a)); }

}  // namespace cvtflow::oracle
