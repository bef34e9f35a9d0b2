"""Pictures of deformed bodies: their outer surface seen from one direction, painted from back to front, coloured by the displacement."""

import numpy
from matplotlib import cm, colors
from matplotlib.collections import PolyCollection

from figures import new_figure, png_of
from solid_states import face_grid, outer_faces

AXES = "xyz"
FACETS_OF_A_PICTURE = 5000
SHADE = 0.28  # how much darker a facet is that stands edge-on
FLAT = 0.15  # a body thinner than this share of its other extents is looked at straight
VISIBLE = 0.02  # displacements below this share of the size of the bodies are drawn enlarged
EDGE_COLOUR = (0.1, 0.12, 0.15)
INK = "#444"
MARGIN_BELOW = 0.16  # of the width of a picture, for the bar and the axes


class Camera:
    """Parallel projection: `right`, `up` and `towards` the viewer are perpendicular unit vectors."""

    def __init__(self, towards, up):
        self.towards = numpy.array(towards, dtype=float) / numpy.linalg.norm(towards)
        right = numpy.cross(up, self.towards)
        self.right = right / numpy.linalg.norm(right)
        self.up = numpy.cross(self.towards, self.right)

    def flat(self, points):
        """Horizontal and vertical place in the picture."""
        return numpy.stack([points @ self.right, points @ self.up], axis=-1)


def along(axis):
    """Towards the end of an axis: from downstream, with y (or z) upward."""
    return Camera(numpy.eye(3)[axis], numpy.eye(3)[1 if axis != 1 else 2])


def from_the_side(axis):
    """Across an axis, which points to the right (along y: upward)."""
    return Camera((0, 0, 1), (0, 1, 0)) if axis != 2 else Camera((1, 0, 0), (0, 1, 0))


def sensible_camera(low, high):
    """For bodies between two corners: straight onto flat ones, obliquely from above otherwise; y points upward, the longer of x and z across."""
    extent = high - low
    thin = int(extent.argmin())
    if extent[thin] < FLAT * numpy.sort(extent)[1]:
        return from_the_side(0) if thin == 2 else along(thin)
    return Camera((0.45, 0.4, 1), (0, 1, 0)) if extent[0] >= extent[2] else Camera((1, 0.4, 0.45), (0, 1, 0))


def length_unit(largest):
    """Factor and unit that make a length [m] a number between about one and a thousand."""
    return (1.0, "m") if largest >= 1 else (1e3, "mm") if largest >= 1e-3 else (1e6, "µm")


def time_words(time, end):
    return f"t = {1e3 * time:.4g} ms" if end < 1 else f"t = {time:.4g} s"


def round_down(value):
    """The next smaller 1, 2 or 5 times a power of ten."""
    power = 10.0 ** numpy.floor(numpy.log10(value))
    return power * max(step for step in (1, 2, 5) if step * power <= value * (1 + 1e-12))


class Painter:
    """The bodies of a run, ready to be drawn. Moved places are rest plus `enlarged` times displacement."""

    def __init__(self, bodies, moments, may_enlarge=True):
        self.bodies, self.moments = bodies, moments
        self.faces = [outer_faces(body) for body in bodies]
        self.used = [numpy.unique(faces) for faces in self.faces]
        n_pieces = int(numpy.clip(numpy.sqrt(FACETS_OF_A_PICTURE / max(1, sum(map(len, self.faces)))), 1, 8))
        self.grids = [face_grid(faces.shape[1], n_pieces) for faces in self.faces]
        self.edge_opacity = float(numpy.clip(0.55 - sum(map(len, self.faces)) / 10000, 0.15, 0.5))
        rest = numpy.concatenate([body.position[used] for body, used in zip(bodies, self.used)])
        self.size = float(numpy.linalg.norm(numpy.ptp(rest, axis=0)))
        moved = [self.displacement(b, moment)[self.used[b]] for b in range(len(bodies)) for moment in moments]
        self.largest = max(float(numpy.linalg.norm(part, axis=1).max()) for part in moved)
        is_small = may_enlarge and 0 < self.largest < VISIBLE * self.size
        self.enlarged = float(round_down(2 * VISIBLE * self.size / self.largest)) if is_small else 1.0
        places = [self.place(b, moment)[self.used[b]] for b in range(len(bodies)) for moment in moments]
        self.corners = numpy.array([numpy.min([part.min(axis=0) for part in places], axis=0),
                                    numpy.max([part.max(axis=0) for part in places], axis=0)])
        self.places = numpy.concatenate(places)
        self.colours = cm.ScalarMappable(colors.Normalize(0, self.largest or 1.0), "viridis")

    def displacement(self, b, moment):
        """State nearest to that of the first body: those of all bodies are stored together."""
        body = self.bodies[b]
        state = moment if b == 0 else body.nearest(self.bodies[0].time[moment])
        return body.field(state, "displacement")

    def place(self, b, moment):
        return self.bodies[b].position + self.enlarged * self.displacement(b, moment)

    def colours_of_lengths(self):
        """The scale of colours in a readable unit."""
        return cm.ScalarMappable(colors.Normalize(0, length_unit(self.largest)[0] * (self.largest or 1.0)), "viridis")

    def limits(self, camera):
        """Left, right, bottom, top of a picture that holds all moments."""
        flat = camera.flat(self.places)
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = 0.03 * max(high - low)
        width = high[0] - low[0] + 2 * margin
        return numpy.array([low[0] - margin, high[0] + margin, low[1] - margin - MARGIN_BELOW * width, high[1] + margin])

    def _facets(self, b, moment, camera):
        """Of one body, those turned to the viewer: outlines, colours, depths; then the sides on edges of elements: lines, depths."""
        weights, facets, borders = self.grids[b]
        faces, displacement = self.faces[b], self.displacement(b, moment)
        point = numpy.einsum("pn,fnc->fpc", weights, self.bodies[b].position[faces] + self.enlarged * displacement[faces])
        amount = numpy.linalg.norm(numpy.einsum("pn,fnc->fpc", weights, displacement[faces]), axis=-1)
        corner = point[:, facets]  # (n_faces, n_facets, 4, 3)
        normal = numpy.cross(corner[:, :, 2] - corner[:, :, 0], corner[:, :, 3] - corner[:, :, 1])
        double = facets[:, 2] == facets[:, 3]  # triangles
        normal[:, double] = numpy.cross(corner[:, double, 1] - corner[:, double, 0], corner[:, double, 2] - corner[:, double, 0])
        length = numpy.linalg.norm(normal, axis=-1)
        turned = (normal @ camera.towards) / numpy.where(length > 0, length, 1)  # 1: faces the viewer
        depth = corner.mean(axis=2) @ camera.towards
        is_seen = turned > 0
        colour = self.colours.to_rgba(amount[:, facets].mean(axis=2)[is_seen])
        colour[:, :3] *= 1 - SHADE * (1 - turned[is_seen, None])
        owner = borders[:, 2]
        side_seen = is_seen[:, owner]
        return (camera.flat(corner[is_seen]), colour, depth[is_seen],
                camera.flat(point[:, borders[:, [0, 1, 1, 0]]][side_seen]), depth[:, owner][side_seen])

    def draw(self, axes, moment, camera, limits):
        outlines, colour, order = [], [], []
        edge = (*EDGE_COLOUR, self.edge_opacity)
        for b in range(len(self.bodies)):
            facets, facet_colour, facet_depth, sides, side_depth = self._facets(b, moment, camera)
            outlines += [facets, sides]
            order += [facet_depth, side_depth + 1e-9 * self.size]
            colour += [numpy.hstack([facet_colour, facet_colour]), numpy.tile((0, 0, 0, 0, *edge), (len(sides), 1))]
        turn = numpy.argsort(numpy.concatenate(order), kind="stable")
        colour = numpy.concatenate(colour)[turn]
        axes.add_collection(PolyCollection(numpy.concatenate(outlines)[turn], facecolors=colour[:, :4], edgecolors=colour[:, 4:],
                                           linewidths=0.35, joinstyle="round"))
        axes.set(xlim=limits[:2], ylim=limits[2:], aspect="equal")
        axes.set_axis_off()


def picture(painter, cameras, titles, n_columns, outline=None):
    """All moments from each camera, on one scale of lengths and colours: PNG. `outline(axes, camera)` draws what does not move."""
    rows = [[(camera, moment, title) for moment, title in zip(painter.moments[i:i + n_columns], titles[i:i + n_columns])]
            for i in range(0, len(titles), n_columns) for camera in cameras]
    limits = {id(camera): painter.limits(camera) for camera in cameras}
    proportions = [(limits[id(row[0][0])][3] - limits[id(row[0][0])][2]) / (limits[id(row[0][0])][1] - limits[id(row[0][0])][0]) for row in rows]
    width = 8.9 / n_columns
    heights = [numpy.clip(width * proportion, 0.5, 6) + 0.3 for proportion in proportions]
    chart, grid = new_figure(len(rows), n_columns, width=9.6, height=sum(heights) / len(rows), squeeze=False,
                             gridspec_kw={"height_ratios": heights})
    for axes in grid.flat:
        axes.set_axis_off()
    for r, row in enumerate(rows):
        for axes, (camera, moment, title) in zip(grid[r], row):
            painter.draw(axes, moment, camera, limits[id(camera)])
            if outline:
                outline(axes, camera)
            if camera is cameras[0]:
                axes.set_title(title, fontsize=8.5)
        if r < len(cameras):
            draw_axes_and_length(grid[r][0], row[0][0], limits[id(row[0][0])])
    bar = chart.colorbar(painter.colours_of_lengths(), ax=grid, shrink=min(1.0, 2.6 / sum(heights)), pad=0.01, aspect=22)
    bar.set_label(f"displacement [{length_unit(painter.largest)[1]}]", fontsize=8.5)
    bar.ax.tick_params(labelsize=8)
    return png_of(chart, dots_per_inch=160)


def draw_axes_and_length(axes, camera, limits):
    """In the lower margin of a picture: a bar of a round length, and where the axes of space point to."""
    width = limits[1] - limits[0]
    bar, arrow = round_down(0.3 * width), 0.6 * MARGIN_BELOW * width
    factor, unit = length_unit(bar)
    start = numpy.array([limits[0], limits[2]]) + 0.03 * width
    axes.plot([start[0], start[0] + bar], [start[1]] * 2, color=INK, linewidth=1.6, solid_capstyle="butt")
    axes.annotate(f"{factor * bar:g} {unit}", start, xytext=(0, 3), textcoords="offset points", fontsize=7.5, color=INK)
    origin = numpy.array([limits[1] - 0.16 * width, limits[2] + 0.03 * width])
    for axis, direction in zip(AXES, camera.flat(numpy.eye(3))):
        if numpy.linalg.norm(direction) < 0.05:
            continue
        axes.annotate("", origin + arrow * direction, origin,
                      arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6})
        axes.annotate(axis, origin + 1.3 * arrow * direction, fontsize=7.5, color=INK, ha="center", va="center")
