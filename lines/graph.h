// The sides of pixels that lines run along as a graph: its nodes are the corners of pixels, its edges those sides.
// There is a bit for each side of the picture; edges are numbered in the order of the bits.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace umbrage {

/// A side between two neighbouring pixels.
struct Edge {
  int x = 0, y = 0;            // the first of both pixels
  bool below = false;          // whether the second lies below it, or to its right
  std::uint8_t kind = 0;       // above 0, and the caller's: the higher, the surer
  std::uint8_t step_kind = 0;  // that of a side which closes a step next to this one
  float strength = 0.0f;       // confidence, in units of the caller's threshold
  float place = 0.5f;          // of the line, from the one pixel's centre to the other's, 0 to 1
};

class EdgeGraph {
 public:
  /// A corner of pixels: its row, and its column in the lower 32 bits.
  using Node = std::int64_t;
  static constexpr int kWays = 4;  // up, right, down, left

  /// The graph of sides of a picture that is width x height pixels. Of two edges on one side the one of higher kind
  /// counts, of equals the stronger. A side that is missing between an edge's loose end and another edge is added, in
  /// the order of `edges`, with the edge's strength and `step_kind`. Fails a check where an edge lies outside the
  /// picture or has no kind.
  EdgeGraph(std::vector<Edge> edges, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
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
  void set(const Edge& e) { bits_[bit(e) / 64] |= std::uint64_t(1) << (bit(e) % 64); }
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
