// Winding: the order of a triangle's corners, which decides the side its normal is on.
#include "scene/winding.h"

#include <utility>

namespace umbrage {

bool unify_winding(Mesh& mesh, const MeshCorners& corners) {
  using Index = MeshIndex;
  enum State : std::uint8_t { kUnseen, kAsItIs, kTurned };
  const std::size_t count = corners.faces.size();
  std::vector<std::uint8_t> state(count, kUnseen);
  std::vector<Index> part;
  std::vector<Index> to_turn;
  for (Index seed = 0; seed < count; ++seed) {
    if (state[seed] != kUnseen) continue;
    part.assign(1, seed);
    state[seed] = kAsItIs;
    std::size_t turned = 0;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Index face = part[i];
      for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
        const EdgeNeighbor other = edge_neighbor(corners, corner);
        if (other.face == kNoIndex32 || state[other.face] != kUnseen) continue;
        const bool turn = (state[face] == kTurned) != other.same_direction;
        state[other.face] = turn ? kTurned : kAsItIs;
        turned += turn;
        part.push_back(other.face);
      }
    }
    const State minority = 2 * turned > part.size() ? kAsItIs : kTurned;
    for (const Index face : part)
      if (state[face] == minority) to_turn.push_back(face);
  }
  for (const Index face : to_turn) std::swap(mesh.indices[3 * face + 1], mesh.indices[3 * face + 2]);
  return !to_turn.empty();
}

}  // namespace umbrage
