// The pixel edges that lines run along, as a graph. Its nodes are pixel corners; its edges are some of the sides
// between pixels. A bit set has one bit for each side in the picture; edges are numbered in the order of their bits.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace umbrage {

/// An edge: a side between two neighbouring pixels along which a line runs.
struct Edge {
  int x = 0, y = 0;            // the first of the two pixels
  bool below = false;          // whether the second pixel is below the first; else it is to its right
  std::uint8_t kind = 0;       // > 0, defined by the caller; higher kinds are more reliable
  std::uint8_t step_kind = 0;  // kind of an edge that is added at a loose end of this one
  float strength = 0.0f;       // confidence, in units of the caller's threshold
  float place = 0.5f;          // where the line crosses between the centres of the two pixels, 0 to 1
};

/// Returns the edges without those in blocks of 32 x 32 pixels that have more than 1.5 edges per pixel: these are
/// noise.
std::vector<Edge> without_noise(std::vector<Edge> edges, int width);

class EdgeGraph {
 public:
  /// A pixel corner: its row, and its column in the lower 32 bits.
  using Node = std::int64_t;
  static constexpr int kWays = 4;  // up, right, down, left

  /// Builds the graph for a picture of width x height pixels. If two edges are on one side, the one of higher kind is
  /// kept; if their kinds are equal, the stronger one. Then, in the order of `edges`: if an edge has a loose end and
  /// one side would connect that to another edge, an edge is added there, with the loose edge's strength and
  /// `step_kind`. Fails a check if an edge is outside the picture or has kind 0.
  EdgeGraph(std::vector<Edge> edges, int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  int size() const { return int(edges_.size()); }
  const Edge& operator[](int edge) const { return edges_[edge]; }
  Node first_node(int edge) const { return first_node(edges_[edge]); }
  Node last_node(int edge) const { return last_node(edges_[edge]); }

  /// Returns a bit mask of the directions (0 up, 1 right, 2 down, 3 left) in which edges leave a node.
  unsigned ways(Node node) const;
  int degree(Node node) const { return std::popcount(ways(node)); }
  /// Returns the edge that leaves a node in direction `way`; there must be one.
  int edge(Node node, int way) const { return number(side(node, way)); }
  /// Returns the neighbouring node in direction `way`.
  static Node next(Node node, int way);
  static int opposite(int way) { return (way + 2) % kWays; }
  bool at_border(Node node) const;
  /// Returns a number, below 2 size(), that identifies a node that has an edge.
  int number_of(Node node) const;
  Node node(int number) const { return number % 2 ? last_node(number / 2) : first_node(number / 2); }
  /// Returns the position of a node, in pixels from the picture's upper left corner.
  static std::array<float, 2> position(Node node) { return {float(column(node)), float(row(node))}; }

 private:
  static Node node_at(int x, int y) { return Node(y) << 32 | x; }
  static Node first_node(const Edge& e);
  static Node last_node(const Edge& e) { return node_at(e.x + 1, e.y + 1); }
  static int column(Node node) { return int(node & 0xffffffff); }
  static int row(Node node) { return int(node >> 32); }
  /// Returns the side from a node in direction `way`; only x, y and below are set.
  static Edge side(Node node, int way);
  // There is a row of bits above the picture, and some bits before and after each row, that are never set.
  std::size_t bit(const Edge& e) const { return std::size_t(e.y + 1) * row_bits_ + std::size_t(2 * e.x + e.below + 2); }
  void set(const Edge& e) { bits_[bit(e) / 64] |= std::uint64_t(1) << (bit(e) % 64); }
  int number(const Edge& side) const;
  void number_edges(const std::vector<Edge>& all);
  void add_steps(std::vector<Edge>& edges);

  int width_, height_;
  std::size_t row_bits_;
  std::vector<Edge> edges_;
  std::vector<std::uint64_t> bits_;  // a bit for each side
  std::vector<int> edges_before_;    // number of edges in the words of bits before each word
};

}  // namespace umbrage
