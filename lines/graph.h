// The pixel edges that lines run along, as a graph: its nodes are pixel corners, its edges the sides between pixels.
// There is one bit for each side in the picture; edges are numbered in the order of the bits.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace umbrage {

/// A side between two neighbouring pixels.
struct Edge {
  int x = 0, y = 0;            // the first of the two pixels
  bool below = false;          // whether the second pixel is below the first, or to its right
  std::uint8_t kind = 0;       // defined by the caller, > 0: the higher, the more reliable
  std::uint8_t step_kind = 0;  // kind of a side that closes a step next to this one
  float strength = 0.0f;       // confidence, in units of the caller's threshold
  float place = 0.5f;          // position of the line between the centres of the two pixels, 0 to 1
};

class EdgeGraph {
 public:
  /// A pixel corner: its row, and its column in the lower 32 bits.
  using Node = std::int64_t;
  static constexpr int kWays = 4;  // up, right, down, left

  /// Builds the graph for a picture of width x height pixels. Of two edges on one side the one of higher kind is kept,
  /// of equal kinds the stronger. A missing side between an edge's loose end and another edge is added, in the order of
  /// `edges`, with the edge's strength and `step_kind`. Fails a check if an edge is outside the picture or has kind 0.
  EdgeGraph(std::vector<Edge> edges, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int size() const { return int(edges_.size()); }
  const Edge& operator[](int edge) const { return edges_[edge]; }
  Node first_node(int edge) const { return first_node(edges_[edge]); }
  Node last_node(int edge) const { return last_node(edges_[edge]); }

  /// Returns the directions in which edges leave a node, one bit each.
  unsigned ways(Node node) const;
  int degree(Node node) const { return std::popcount(ways(node)); }
  /// Returns the edge that leaves a node in that direction; there must be one.
  int edge(Node node, int way) const { return number(side(node, way)); }
  static Node next(Node node, int way);
  static int back(int way) { return (way + 2) % kWays; }
  bool at_border(Node node) const;
  /// Returns a number, below 2 size(), of a node that has an edge.
  int number_of(Node node) const;
  Node node(int number) const { return number % 2 ? last_node(number / 2) : first_node(number / 2); }
  /// Returns the position in pixels from the picture's upper left corner.
  static std::array<float, 2> place(Node node) { return {float(column(node)), float(row(node))}; }

 private:
  static Node node_at(int x, int y) { return Node(y) << 32 | x; }
  static Node first_node(const Edge& e);
  static Node last_node(const Edge& e) { return node_at(e.x + 1, e.y + 1); }
  static int column(Node node) { return int(node & 0xffffffff); }
  static int row(Node node) { return int(node >> 32); }
  /// Returns the side from a node in that direction.
  static Edge side(Node node, int way);
  // The bits of a row above the picture and some bits before and after each row are never set.
  std::size_t bit(const Edge& e) const { return std::size_t(e.y + 1) * row_bits_ + std::size_t(2 * e.x + e.below + 2); }
  void set(const Edge& e) { bits_[bit(e) / 64] |= std::uint64_t(1) << (bit(e) % 64); }
  int number(const Edge& side) const;
  void number_edges(const std::vector<Edge>& all);
  void fill_steps(std::vector<Edge>& edges);

  int width_, height_;
  std::size_t row_bits_;
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> bits_;  // a bit for each side
  std::vector<int> before_;          // number of edges before each word of bits
};

}  // namespace umbrage
