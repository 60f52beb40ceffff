// The edges between a picture's pixels as a graph: its nodes are the corners of pixels, its edges those sides of pixels
// that an edge of the picture passes along. There is a bit for each side; edges are numbered in the order of the bits.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "effects/outline/outline.h"
#include "kernel/host_frame.h"

namespace umbrage {

/// An edge between two neighbouring pixels.
struct Edge {
  int x = 0, y = 0;       // the first of both pixels
  bool below = false;     // whether the second lies below it, or to its right
  std::uint8_t kind = 0;  // kOutlineCrease, kOutlineDepth, kOutlineId
  float strength = 0.0f;  // in units of its threshold
  float place = 0.5f;     // from the one pixel's centre to the other's, 0 to 1
};

class EdgeGraph {
 public:
  /// A corner of pixels: its row, and its column in the lower 32 bits.
  using Node = std::int64_t;
  static constexpr int kWays = 4;  // up, right, down, left

  /// Of planes that outline_edges has written.
  EdgeGraph(const HostPlane& right, const HostPlane& below, int width, int height);

  int size() const { return int(edges_.size()); }
  const Edge& operator[](int edge) const { return edges_[edge]; }
  Node first_node(int edge) const { return first_node(edges_[edge]); }
  Node last_node(int edge) const { return last_node(edges_[edge]); }

  /// In which ways edges leave a node: a bit for each.
  unsigned ways(Node node) const;
  int degree(Node node) const { return std::popcount(ways(node)); }
  /// The edge that leaves a node that way, in which there is one.
  int edge(Node node, int way) const { return number(side(node, way)); }
  static Node next(Node node, int way);
  static int back(int way) { return (way + 2) % kWays; }
  bool at_border(Node node) const;
  /// A number of a node that an edge leaves, below 2 size().
  int number_of(Node node) const;
  Node node(int number) const { return number % 2 ? last_node(number / 2) : first_node(number / 2); }
  /// In pixels from the picture's upper left corner.
  static std::array<float, 2> place(Node node) { return {float(column(node)), float(row(node))}; }

 private:
  static Node node_at(int x, int y) { return Node(y) << 32 | x; }
  static Node first_node(const Edge& e);
  static Node last_node(const Edge& e) { return node_at(e.x + 1, e.y + 1); }
  static int column(Node node) { return int(node & 0xffffffff); }
  static int row(Node node) { return int(node >> 32); }
  /// The side of pixels along which one goes from a node that way.
  static Edge side(Node node, int way);
  // A row above the picture and some bits before and behind each of its rows are never set.
  std::size_t bit(const Edge& e) const { return std::size_t(e.y + 1) * row_bits_ + std::size_t(2 * e.x + e.below + 2); }
  int number(const Edge& side) const;
  void number_edges(const std::vector<Edge>& all);
  void fill_steps(std::vector<Edge>& edges);

  int width_, height_;
  std::size_t row_bits_;
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> bits_;  // a bit for each side
  std::vector<int> before_;          // edges before each word of bits
};

}  // namespace umbrage
