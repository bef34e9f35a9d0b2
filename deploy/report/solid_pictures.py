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
LUMINANCE = numpy.array([0.21, 0.72, 0.07])
INK = "#444"
LEGEND_HEIGHT = 0.42  # below the first picture from each direction, for the bar and the axes [inch]


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

    def __init__(self, bodies, moments, may_enlarge=True, scalar=None):
        self.bodies, self.moments, self.scalar = bodies, moments, scalar
        self.faces = [outer_faces(body) for body in bodies]
        self.used = [numpy.unique(numpy.concatenate([faces.ravel() for faces in groups])) for groups in self.faces]
        n_faces = sum(len(faces) for groups in self.faces for faces in groups)
        self.n_pieces = int(numpy.clip(numpy.sqrt(FACETS_OF_A_PICTURE / max(1, n_faces)), 1, 8))
        self.edge_opacity = float(numpy.clip(0.55 - n_faces / 10000, 0.15, 0.5))
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
        if scalar:
            shown = numpy.concatenate([self.amount(b, moment)[self.used[b]] for b in range(len(bodies)) for moment in moments])
            self.colours = cm.ScalarMappable(colors.Normalize(*numpy.nanpercentile(shown, (1, 99))), "viridis")

    def displacement(self, b, moment):
        return self.field(b, moment, "displacement")

    def field(self, b, moment, name):
        """State nearest to that of the first body: those of all bodies are stored together."""
        body = self.bodies[b]
        state = moment if b == 0 else body.nearest(self.bodies[0].time[moment])
        return body.field(state, name)

    def amount(self, b, moment):
        """What colours a node: the size of its displacement, or the scalar."""
        return self.field(b, moment, self.scalar).ravel() if self.scalar else numpy.linalg.norm(self.displacement(b, moment), axis=1)

    def place(self, b, moment):
        return self.bodies[b].position + self.enlarged * self.displacement(b, moment)

    def scale(self):
        """The scale of colours in a readable unit, and its words."""
        if self.scalar:
            limits = 1e-3 * numpy.array(self.colours.get_clim())
            return cm.ScalarMappable(colors.Normalize(*limits), "viridis"), f"{self.scalar.replace('_', ' ')} [kPa]"
        return cm.ScalarMappable(colors.Normalize(0, length_unit(self.largest)[0] * (self.largest or 1.0)), "viridis"), f"displacement [{length_unit(self.largest)[1]}]"

    def limits(self, camera):
        """Left, right, bottom, top of a picture that holds all moments."""
        flat = camera.flat(self.places)
        low, high = flat.min(axis=0), flat.max(axis=0)
        margin = 0.03 * max(high - low)
        return numpy.array([low[0] - margin, high[0] + margin, low[1] - margin, high[1] + margin])

    def _facets(self, b, faces, displacement, camera, scalar=None):
        """Of some faces of a body, those turned to the viewer: outlines, colours, depths; then the same of the sides on edges of elements."""
        weights, facets, borders = face_grid(faces.shape[1], self.n_pieces)
        point = numpy.einsum("pn,fnc->fpc", weights, self.bodies[b].position[faces] + self.enlarged * displacement[faces])
        amount = (numpy.linalg.norm(numpy.einsum("pn,fnc->fpc", weights, displacement[faces]), axis=-1) if scalar is None
                  else numpy.einsum("pn,fn->fp", weights, scalar[faces]))
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
        edge = numpy.zeros((*is_seen.shape, 4))
        edge[is_seen] = self._edge_colour(colour)
        return (camera.flat(corner[is_seen]), colour, depth[is_seen],
                camera.flat(point[:, borders[:, [0, 1, 1, 0]]][side_seen]), edge[:, owner][side_seen], depth[:, owner][side_seen])

    def _edge_colour(self, colour):
        """Darker than a light facet, lighter than a dark one."""
        is_dark = colour[:, :3] @ LUMINANCE < 0.3
        edge = numpy.where(is_dark[:, None], 1.0, 0.0) * numpy.ones((1, 4))
        edge[:, 3] = self.edge_opacity
        return edge

    def draw(self, axes, moment, camera, limits):
        outlines, colour, order = [], [], []
        for b, groups in enumerate(self.faces):
            displacement = self.displacement(b, moment)
            scalar = self.amount(b, moment) if self.scalar else None
            for faces in groups:
                facets, facet_colour, facet_depth, sides, side_colour, side_depth = self._facets(b, faces, displacement, camera, scalar)
                outlines += [facets, sides]
                order += [facet_depth, side_depth + 1e-9 * self.size]
                colour += [numpy.hstack([facet_colour, facet_colour]), numpy.hstack([numpy.zeros((len(sides), 4)), side_colour])]
        turn = numpy.argsort(numpy.concatenate(order), kind="stable")
        colour = numpy.concatenate(colour)[turn]
        axes.add_collection(PolyCollection(numpy.concatenate(outlines)[turn], facecolors=colour[:, :4], edgecolors=colour[:, 4:],
                                           linewidths=0.35, joinstyle="round"))
        axes.set(xlim=limits[:2], ylim=limits[2:], aspect="equal")
        axes.set_axis_off()


def picture(painter, cameras, titles, n_columns, outline=None):
    """All moments from each camera, on one scale of lengths and colours: PNG. `outline(axes, camera)` draws what does not move."""
    width = 8.9 / n_columns
    starts = range(0, len(titles), n_columns)
    rows = [(camera, start) for start in starts for camera in cameras]
    limits, heights = [], []
    for camera, start in rows:
        left, right, bottom, top = painter.limits(camera)
        legend = LEGEND_HEIGHT if start == 0 else 0
        limits.append(numpy.array([left, right, bottom - legend * (right - left) / width, top]))
        heights.append(legend + numpy.clip(width * (top - bottom) / (right - left), 0.5, 6) + (0.35 if camera is cameras[0] else 0.1))
    chart, grid = new_figure(len(rows), n_columns, width=9.6, height=sum(heights) / len(rows), squeeze=False,
                             gridspec_kw={"height_ratios": heights})
    for axes in grid.flat:
        axes.set_axis_off()
    for (camera, start), row, box in zip(rows, grid, limits):
        for axes, moment, title in zip(row, painter.moments[start:start + n_columns], titles[start:]):
            painter.draw(axes, moment, camera, box)
            if outline:
                outline(axes, camera)
            if camera is cameras[0]:
                axes.set_title(title, fontsize=8.5)
        if start == 0:
            draw_axes_and_length(row[0], camera, box, LEGEND_HEIGHT * (box[1] - box[0]) / width)
    scale, words = painter.scale()
    bar = chart.colorbar(scale, ax=grid, shrink=min(1.0, 2.6 / sum(heights)), pad=0.01, aspect=22)
    bar.set_label(words, fontsize=8.5)
    bar.ax.tick_params(labelsize=8)
    return png_of(chart, dots_per_inch=160)


def draw_axes_and_length(axes, camera, limits, height):
    """In the lowest part of a picture: a bar of a round length, and where the axes of space point to."""
    width = limits[1] - limits[0]
    bar = round_down(0.35 * width)
    factor, unit = length_unit(bar)
    start = numpy.array([limits[0] + 0.02 * width, limits[2] + 0.15 * height])
    axes.plot([start[0], start[0] + bar], [start[1]] * 2, color=INK, linewidth=1.6, solid_capstyle="butt")
    axes.annotate(f"{factor * bar:g} {unit}", start, xytext=(0, 3), textcoords="offset points", fontsize=7.5, color=INK)
    arrow = 0.5 * height
    directions = camera.flat(numpy.eye(3))
    origin = numpy.array([limits[1] - 0.02 * width, limits[2] + 0.12 * height]) - arrow * (1.4 * directions.max(axis=0) * (1, 0)
                                                                                          + 1.2 * numpy.minimum(directions.min(axis=0), 0) * (0, 1))
    for axis, direction in zip(AXES, directions):
        if numpy.linalg.norm(direction) < 0.05:
            continue
        axes.annotate("", origin + arrow * direction, origin, annotation_clip=False,
                      arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 6})
        axes.annotate(axis, origin + (arrow + 0.2 * height / numpy.linalg.norm(direction)) * direction, fontsize=7.5, color=INK, ha="center",
                      va="center", annotation_clip=False)
