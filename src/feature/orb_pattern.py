#!/ usr / bin / env python3
# SPDX-License-Identifier: Apache-2.0
"""Computes the 256 pixel pairs of the descriptor and prints orb_pattern.cc (then run clang-format). Needs nothing but Python; takes a minute.

rBRIEF (Rublee et al., "ORB: an efficient alternative to SIFT or SURF", ICCV 2011, section 4.3) looks for tests that are
uncorrelated and have means near 0.5, greedily, over a training set of patches. We do the same without a training set:
patches are taken as a stationary Gaussian process, whose covariance of two pixels falls exponentially with their distance.
Covariances of tests (differences of two pixels) follow in closed form, and so does the effect of turning the patch to its
orientation: the first moment across it is zero, which conditions the covariance, and the one along it is positive, which
biases tests that correlate with it.
"""
import math
import random

RADIUS = 15  # pixels lie within
MIN_DISTANCE = 4  # of the pixels of a pair
CORRELATION_LENGTH = 12.0  # pixels
SMOOTHING = 2.0  # pixels: pixels nearer than this are nearly equal
CANDIDATES = 20000
TESTS = 256


def covariance_table():
    """Covariance of two pixels by their squared distance."""
    size = 2 * (2 * RADIUS + 1) ** 2
    return [math.exp(-math.sqrt(d2 + SMOOTHING**2) / CORRELATION_LENGTH) for d2 in range(size)]


TABLE = covariance_table()


def pixels(ax, ay, bx, by):
    return TABLE[(ax - bx) ** 2 + (ay - by) ** 2]


def moment_covariances():
    """Covariances of every pixel with the patch's moment in x; and the variance of that moment."""
    span = range(-RADIUS, RADIUS + 1)
    disc = [(x, y) for y in span for x in span if x * x + y * y <= RADIUS * (RADIUS + 1)]
    cov = {(x, y): sum(u * pixels(x, y, u, v) for u, v in disc) for y in span for x in span}
    return cov, sum(x * cov[x, y] for x, y in disc)


def candidates():
    """Tests (ax, ay, bx, by, variance, covariance with the normalized moment in y), least biased first."""
    moment, moment_variance = moment_covariances()
    sigma = math.sqrt(moment_variance)
    generator = random.Random(1)

    def draw():
        while True:
            x, y = (math.floor(generator.uniform(-RADIUS, RADIUS) + 0.5) for _ in range(2))
            if x * x + y * y <= RADIUS * RADIUS:
                return x, y

    pool = []
    while len(pool) < CANDIDATES:
        (ax, ay), (bx, by) = draw(), draw()
        if (ax - bx) ** 2 + (ay - by) ** 2 < MIN_DISTANCE**2:
            continue
        along = (moment[ax, ay] - moment[bx, by]) / sigma
        across = (moment[ay, ax] - moment[by, bx]) / sigma  # by symmetry
        variance = 2 * (TABLE[0] - pixels(ax, ay, bx, by)) - across**2
        pool.append((abs(along) / math.sqrt(variance), (ax, ay, bx, by, variance, across)))
    pool.sort(key=lambda entry: entry[0])
    return [test for _, test in pool]


def correlated(a, b, limit):
    ax, ay, bx, by, variance_a, across_a = a
    cx, cy, dx, dy, variance_b, across_b = b
    c = pixels(ax, ay, cx, cy) - pixels(ax, ay, dx, dy) - pixels(bx, by, cx, cy) + pixels(bx, by, dx, dy)
    return abs(c - across_a * across_b) > limit * math.sqrt(variance_a * variance_b)


def choose():
    """The first tests of which no two are more correlated than the lowest limit, in steps of 5 %, that yields enough."""
    pool = candidates()
    limit = 0.4
    while True:
        chosen = []
        for test in pool:
            if not any(correlated(test, other, limit) for other in chosen):
                chosen.append(test)
                if len(chosen) == TESTS:
                    return chosen
        limit *= 1.05


def main():
    print("// Made by orb_pattern.py: do not edit.")
    print('#include "feature/orb_pattern.h"\n')
    print("namespace rds {\n")
    print("const std::array<PixelPair, 256>& OrbPattern() {")
    print("static constexpr std::array<PixelPair, 256> kPattern = {{")
    for ax, ay, bx, by, _, _ in choose():
        print(f"    {{{ax}, {ay}, {bx}, {by}}},")
    print("}};")
    print("return kPattern;\n}\n")
    print("}  // namespace rds")


if __name__ == "__main__":
    main()
