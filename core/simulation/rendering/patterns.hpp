#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/geometry/types.hpp"
#include "core/simulation/random.hpp"

namespace evbench {

/// A picture to put on a surface: grey values of 8 bits, as displays show them.
struct Pattern {
  cv::Mat picture;
  std::vector<Vector2> features;  ///< locations that can be tracked [px of the picture], first pixel's centre at 0
};

/// Dark discs of this diameter on white, at random places but apart: one in each square of three diameters. Features:
/// their centres.
Pattern draw_dots(int side, double diameter, Random& random);

/// Dark discs, triangles, squares, hexagons, stars and L shapes of about this size and of different greys on white, one
/// in each square of 1.6 sizes.
Pattern draw_shapes(int side, double size, Random& random);

/// Polygons of random grey that cover one another like fallen leaves, from `smallest` to 16 times that in diameter,
/// as many of a size as statistics of natural images ask for (Lee et al. 2001: density ~ diameter⁻³). Rich in corners.
Pattern draw_leaves(int side, double smallest, Random& random);

/// Stripes of random greys, widths from `smallest` to four times that: straight edges, and few corners. They change
/// their direction from one polygon of some 30 `smallest` to the next.
Pattern draw_stripes(int side, double smallest, Random& random);

/// Bare ground of one grey, on which heaps of leaves lie: a fifth of the ground is covered.
Pattern draw_bare(int side, double smallest, Random& random);

/// One small picture of leaves, 25 times `smallest` wide, again and again.
Pattern draw_repeated(int side, double smallest, Random& random);

/// An image file of any format that OpenCV reads. Throws InputError when it can't be read.
Pattern read_picture(const std::string& path);

}  // namespace evbench
