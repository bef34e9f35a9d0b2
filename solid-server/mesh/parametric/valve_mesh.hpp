#pragma once
// Three leaflets in a tube.

#include <array>

#include "solid-server/mesh/parametric/leaflet_surface.hpp"
#include "solid-server/mesh/solid_mesh.hpp"

namespace couplet::solid {

struct ValveShape {
  LeafletShape leaflet;
  double thickness = 0.3e-3;                    // of the leaflets [m]
  double commissure_gap = 0.1e-3;               // between the faces of neighbours where they meet the tube [m]
  std::array<int, 3> n_elements = {20, 16, 1};  // of a leaflet: along the free edge, from its attachment to its free
                                                // edge in the middle, through the thickness
  double contact_fraction = 0.3;  // share of the leaflet below its free edge that may touch the others, of its width
};

/// The tube stands along x, its base, beside the lowest points of the attachments, at x = 0; the flow goes towards
/// positive x. The middle of leaflet 1 stands towards y; leaflets 2 and 3 follow by 120 degrees about x (right-hand).
/// Each has its thickness, along the normal, half to either side of the mid-surface of LeafletSurface, within a sector
/// that is moved away from the axis just so far that the faces of neighbours keep commissure_gap where they meet the
/// tube, and more elsewhere. The base stands on the tube: see LeafletSurface::offset_position. Elements: see
/// LeafletGrid; the third lattice direction goes from the ventricular to the aortic side.
///
/// Regions leaflet_1, leaflet_2, leaflet_3, with axes: circumferential (from commissure to commissure) and across it in
/// the leaflet. Surfaces, for each leaflet with _1, _2, _3 and for all together without: ventricular (towards the axis
/// and upstream; a pressure there pushes the leaflets open, towards the tube), aortic (towards the tube and downstream;
/// a pressure there closes), free_edge, base (the attachment, to be fixed; it ends at the commissures), contact (faces
/// of ventricular within contact_fraction of the free edge: where leaflets meet when closed). Node sets, likewise:
/// commissure (the ends of the base). Markers, on the ventricular side of each leaflet: free_edge_middle_k,
/// lower_belly_k, upper_belly_k (the nodes nearest to a third and two thirds of the way from attachment to free edge,
/// in the leaflet's middle).
///
/// Throws SceneError for a thickness that is not above 0 or a shape that does not fit itself.
SolidMesh make_valve_mesh(const ValveShape& shape);

}  // namespace couplet::solid
