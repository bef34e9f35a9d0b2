#include "flow-server/output/open_face.hpp"

#include "flow-server/immersed/body_geometry.hpp"

namespace couplet::flow {

double open_velocity(const BodyGeometry* bodies, const Field<double>& velocity, int c, const Triple& face) {
  const double u = velocity(face[0], face[1], face[2]);
  if (!bodies) return u;
  const CutCells& cut = bodies->cut();
  const int index = cut.find_face(c, face);
  if (index < 0) return cut.is_face_solid(c, face) ? 0 : u;
  const CutFace& cut_face = cut.faces()[static_cast<std::size_t>(index)];
  double sum = 0;
  for (int p = cut_face.first_piece; p < cut_face.first_piece + cut_face.n_pieces; ++p) {
    const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
    const int part = piece.lower_part >= 0 ? piece.lower_part : piece.upper_part;
    if (part >= 0 && !cut.parts()[static_cast<std::size_t>(part)].is_fluid) continue;
    const int ghost = bodies->layer().ghost_of_piece(p);
    sum += piece.share *
           (ghost < 0 ? u : WallLayer::value_of(bodies->layer().ghosts()[static_cast<std::size_t>(ghost)], velocity));
  }
  return sum;
}

double open_share(const BodyGeometry* bodies, int c, const Triple& face) {
  if (!bodies) return 1;
  const CutCells& cut = bodies->cut();
  const int index = cut.find_face(c, face);
  if (index < 0) return cut.is_face_solid(c, face) ? 0 : 1;
  const CutFace& cut_face = cut.faces()[static_cast<std::size_t>(index)];
  double sum = 0;
  for (int p = cut_face.first_piece; p < cut_face.first_piece + cut_face.n_pieces; ++p) {
    const FacePiece& piece = cut.pieces()[static_cast<std::size_t>(p)];
    const int part = piece.lower_part >= 0 ? piece.lower_part : piece.upper_part;
    if (part < 0 || cut.parts()[static_cast<std::size_t>(part)].is_fluid) sum += piece.share;
  }
  return sum;
}

}  // namespace couplet::flow
