#!/usr/bin/python3
"""A hyperelastic solid by FEniCSx (Debian's python3-dolfinx), as a stranger to solid-server: boxes of the scene language.

Space: serendipity functions of degree 2 on hexahedra, which on a box are those of hexahedra of 20 nodes. Time: the
generalized-alpha method [Chung, Hulbert 1993] with the internal force at the displacement in between and a load that
varies linearly over the step. Both are what solid-server says that it does (its README), so that two programs without a
common line should differ by round-off and tolerances only."""

import logging

import numpy as np

from couplet_participant import Failure, Opened, Participant, Surface, serve

try:
    import ufl
    from dolfinx import fem, mesh
    from dolfinx.fem import petsc as fem_petsc
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as missing:
    ufl, MISSING = None, str(missing)

SIDES = {"x_min": (0, 0), "x_max": (0, 1), "y_min": (1, 0), "y_max": (1, 1), "z_min": (2, 0), "z_max": (2, 1)}
# Corners and midsides of a face on the square from -1 to 1, against the clock.
FACE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]])
DEGREE = {8: 3, 27: 5}  # of the quadrature with so many points in an element
KNOWN = {"": {"body", "time_integration"}, "body[0]": {"name", "box", "material", "fixed", "symmetry", "wetted", "points_per_element", "mass_damping"}}


def refuse(field, why):
    raise Failure("SCENE", why, field, "take solid-server, or extend this example")


def check_scene(solid):
    """Refuses what this example does not compute, rather than leave it out."""
    if len(solid.body) != 1 or not solid.body[0].HasField("box"):
        refuse("solid.body", "is not one box")
    for name, message in (("", solid), ("body[0]", solid.body[0])):
        for field, value in message.ListFields():
            is_default = field.label != field.LABEL_REPEATED and field.message_type is None and value == field.default_value
            if field.name not in KNOWN[name] and not is_default:
                refuse(".".join(filter(None, ["solid", name, field.name])), "is not known to this solver")
    method = solid.time_integration
    if method.method != method.GENERALIZED_ALPHA or method.HasField("largest_substep"):
        refuse("solid.time_integration", "is not GENERALIZED_ALPHA in whole steps")
    for side in (*solid.body[0].fixed, *solid.body[0].wetted, *(one.surface for one in solid.body[0].symmetry)):
        if side not in SIDES:
            refuse("solid.body[0]", f"{side} is no side of the box")


class Box:
    """A box of hexahedra and the nodes of its wetted sides."""

    def __init__(self, body):
        box = body.box
        self.length = np.array([box.length.x, box.length.y, box.length.z])
        self.elements = np.array([box.elements_x, box.elements_y, box.elements_z])
        self.mesh = mesh.create_box(MPI.COMM_SELF, [np.zeros(3), self.length], list(map(int, self.elements)), mesh.CellType.hexahedron)
        self.space = fem.FunctionSpace(self.mesh, ufl.VectorElement("S", self.mesh.ufl_cell(), 2))

    def facets(self, side):
        axis, end = SIDES[side]
        return mesh.locate_entities_boundary(self.mesh, 2, lambda x: np.isclose(x[axis], end * self.length[axis], atol=1e-9 * self.length[axis]))

    def held(self, body):
        """Conditions for fixed sides and planes of symmetry."""
        conditions = []
        for side in body.fixed:
            dofs = fem.locate_dofs_topological(self.space, 2, self.facets(side))
            conditions.append(fem.dirichletbc(fem.Function(self.space), dofs))
        for one in body.symmetry:
            component = self.space.sub({one.X: 0, one.Y: 1, one.Z: 2}[one.normal])
            alone = component.collapse()[0]
            dofs = fem.locate_dofs_topological((component, alone), 2, self.facets(one.surface))
            conditions.append(fem.dirichletbc(fem.Function(alone), dofs, component))
        return conditions

    def surface(self, sides):
        """Faces of 8 nodes on these sides, with normals out of the box."""
        index, faces, region = {}, [], []
        for number, side in enumerate(sides):
            axis, end = SIDES[side]
            first, second = (axis + 1) % 3, (axis + 2) % 3
            if not end:
                first, second = second, first
            for i in range(self.elements[first]):
                for j in range(self.elements[second]):
                    place = np.zeros((8, 3), dtype=int)  # in half elements
                    place[:, axis] = 2 * end * self.elements[axis]
                    place[:, first], place[:, second] = 2 * i + 1 + FACE[:, 0], 2 * j + 1 + FACE[:, 1]
                    faces.append([index.setdefault(tuple(p), len(index)) for p in place])
                    region.append(number)
        return Surface(np.array(list(index)) * self.length / (2 * self.elements), faces, region, list(sides))

    def values_at(self, points):
        """The matrix (3 n_points, n_dofs) that takes coefficients to displacements at points of the box."""
        cells = self.cells_at(points)
        element, cmap, x = self.space.element.basix_element, self.mesh.geometry.cmap, self.mesh.geometry
        matrix = PETSc.Mat().createAIJ([3 * len(points), 3 * self.space.dofmap.index_map.size_local], nnz=20, comm=MPI.COMM_SELF)
        for n, (point, cell) in enumerate(zip(points, cells)):
            reference = cmap.pull_back(point[None, :], x.x[x.dofmap.links(cell)])
            values = element.tabulate(0, reference)[0, 0, :, 0]
            for dof, value in zip(self.space.dofmap.cell_dofs(cell), values):
                for axis in range(3):
                    matrix.setValue(3 * n + axis, 3 * dof + axis, value)
        matrix.assemble()
        return matrix

    def cells_at(self, points):
        """A cell that holds each point, found by the place of its middle on the grid."""
        n_cells = self.mesh.topology.index_map(3).size_local
        middle = np.array([self.mesh.geometry.x[self.mesh.geometry.dofmap.links(c)].mean(axis=0) for c in range(n_cells)])
        grid = {tuple(place): c for c, place in enumerate(np.floor(middle / self.length * self.elements).astype(int))}
        place = np.minimum(np.floor(points / self.length * self.elements * (1 - 1e-12)).astype(int), self.elements - 1)
        return [grid[tuple(p)] for p in place]


def strain_energy(material, u):
    """W(F) as solid-server defines it (couplet describe Material)."""
    law = material.WhichOneof("law")
    F = ufl.Identity(3) + ufl.grad(u)
    if law == "saint_venant_kirchhoff":
        young, nu = material.saint_venant_kirchhoff.young_modulus, material.saint_venant_kirchhoff.poisson_ratio
        E = (F.T * F - ufl.Identity(3)) / 2
        return young * nu / ((1 + nu) * (1 - 2 * nu)) / 2 * ufl.tr(E) ** 2 + young / (2 * (1 + nu)) * ufl.inner(E, E)
    if law == "neo_hookean":
        J = ufl.det(F)
        return (material.neo_hookean.shear_modulus / 2 * (J ** (-2 / 3) * ufl.tr(F.T * F) - 3)
                + material.neo_hookean.bulk_modulus / 2 * (J - 1) ** 2)
    return refuse("solid.body[0].material", f"{law} is not known to this solver")


class Block(Participant):
    """A hyperelastic box by FEniCSx."""

    def open(self, request):
        if ufl is None:
            raise Failure("FILE", f"FEniCSx is not there ({MISSING})", "python3-dolfinx", "apt-get install python3-dolfinx")
        logging.getLogger().setLevel(logging.WARNING)  # it compiles its forms at first use, and tells about each
        solid = request.scene.solid
        check_scene(solid)
        body, method = solid.body[0], solid.time_integration
        self.box = Box(body)
        self.surface = self.box.surface(body.wetted)
        self.at_nodes = self.box.values_at(self.surface.node_position)
        rho = method.spectral_radius
        self.alpha_m, self.alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        self.gamma, self.beta = 0.5 - self.alpha_m + self.alpha_f, (1 - self.alpha_m + self.alpha_f) ** 2 / 4
        self.tolerance, self.iterations_max = method.newton_tolerance, method.newton_iterations_max
        self.set_up_equations(body)
        n_dofs, n_nodes = len(self.u.x.array), len(self.surface.node_position)
        self.time, self.motion, self.force = 0.0, np.zeros((3, n_dofs)), np.zeros((n_nodes, 3))  # u, v, a; force
        self.has_force = False
        if request.resume_from:
            with np.load(request.resume_from, allow_pickle=False) as file:
                self.time, self.motion, self.force = float(file["time"]), file["motion"], file["force"]
            if self.motion.shape != (3, n_dofs):
                raise Failure("FILE", f"holds {self.motion.shape[1]} unknowns, the box has {n_dofs}", request.resume_from, "give the same mesh")
            self.has_force = True
        return Opened(self.surface, ["force"], self.fields(self.motion), self.time)

    def set_up_equations(self, body):
        """The equation of a step in the displacement u at its end, its derivative, and that of the first acceleration."""
        V = self.box.space
        self.u, self.u0, self.v0, self.a0 = (fem.Function(V) for _ in range(4))
        self.step, damping = (fem.Constant(self.box.mesh, PETSc.ScalarType(value)) for value in (1, body.mass_damping))
        w, du, h, beta = ufl.TestFunction(V), ufl.TrialFunction(V), self.step, self.beta
        points = body.points_per_element if body.HasField("points_per_element") else 8
        if points not in DEGREE:
            refuse("solid.body[0].points_per_element", f"{points} is neither 8 nor 27")
        dx_strain = ufl.dx(metadata={"quadrature_degree": DEGREE[points]})
        dx_mass = ufl.dx(metadata={"quadrature_degree": DEGREE[27]})
        a1 = (self.u - self.u0 - h * self.v0) / (beta * h**2) - (0.5 - beta) / beta * self.a0
        v1 = self.v0 + h * ((1 - self.gamma) * self.a0 + self.gamma * a1)

        def between(end, start, alpha):
            return (1 - alpha) * end + alpha * start
        inertia = between(a1, self.a0, self.alpha_m) + damping * between(v1, self.v0, self.alpha_f)
        density = body.material.density
        # The derivative by the displacement in between is that by u, over the share of u in it.
        energy_between = strain_energy(body.material, between(self.u, self.u0, self.alpha_f)) * dx_strain
        internal = 1 / (1 - self.alpha_f) * ufl.derivative(energy_between, self.u, w)
        residual = density * ufl.dot(inertia, w) * dx_mass + internal
        self.held = self.box.held(body)
        self.residual, self.tangent = fem.form(residual), fem.form(ufl.derivative(residual, self.u, du))
        self.mass = fem_petsc.assemble_matrix(fem.form(density * ufl.dot(du, w) * dx_mass), bcs=self.held)
        self.mass.assemble()
        self.energy = [fem.form(density / 2 * ufl.dot(self.v0, self.v0) * dx_mass), fem.form(strain_energy(body.material, self.u0) * dx_strain)]
        self.start_residual = fem.form(ufl.derivative(strain_energy(body.material, self.u0) * dx_strain, self.u0, w)
                                       + density * damping * ufl.dot(self.v0, w) * dx_mass)

    def solve_linear(self, matrix, right_side):
        solver = PETSc.KSP().create(MPI.COMM_SELF)
        solver.setOperators(matrix)
        solver.setType("preonly")
        solver.getPC().setType("lu")
        solution = right_side.duplicate()
        solver.solve(right_side, solution)
        return solution

    def load(self, force):
        """Forces on the wetted nodes as a load on the coefficients: virtual displacements do the same work."""
        nodal = PETSc.Vec().createWithArray(np.ascontiguousarray(force).ravel(), comm=MPI.COMM_SELF)
        load = self.at_nodes.createVecRight()
        self.at_nodes.multTranspose(nodal, load)
        return load

    def first_acceleration(self, load):
        """M a = load - f at the start."""
        rest = fem_petsc.assemble_vector(self.start_residual)
        rest.aypx(-1, load)
        fem_petsc.set_bc(rest, self.held, scale=0)
        return self.solve_linear(self.mass, rest).array.copy()

    def solve_step(self, step, fields):
        force = np.array(fields["force"])
        force_at_start = self.force if self.has_force else force
        motion = self.motion.copy()
        self.u0.x.array[:], self.v0.x.array[:] = motion[0], motion[1]
        if not self.has_force:
            motion[2] = self.first_acceleration(self.load(force_at_start))
        self.a0.x.array[:] = motion[2]
        h = self.step.value = step.duration
        self.u.x.array[:] = motion[0] + h * motion[1] + h * h / 2 * motion[2]
        self.iterate(self.load((1 - self.alpha_f) * force + self.alpha_f * force_at_start), f"t = {step.start + h:g} s")
        u = self.u.x.array.copy()
        a = (u - motion[0] - h * motion[1]) / (self.beta * h * h) - (0.5 - self.beta) / self.beta * motion[2]
        v = motion[1] + h * ((1 - self.gamma) * motion[2] + self.gamma * a)
        self.trial, self.trial_force, self.trial_time = np.array([u, v, a]), force, step.start + h
        return self.fields(self.trial)

    def iterate(self, load, where):
        """Newton's method for u, until the forces are out of balance by the tolerance of the scene."""
        for _ in range(self.iterations_max):
            residual = fem_petsc.assemble_vector(self.residual)
            scale = max(load.norm(), residual.norm(), 1e-300)
            residual.axpy(-1, load)
            fem_petsc.set_bc(residual, self.held, scale=0)
            size = residual.norm()
            if not np.isfinite(size):
                break
            if size <= self.tolerance * scale:
                return
            tangent = fem_petsc.assemble_matrix(self.tangent, bcs=self.held)
            tangent.assemble()
            self.u.x.array[:] -= self.solve_linear(tangent, residual).array
        raise Failure("NUMERICS", "Newton's method finds no balance of forces", where, "take a smaller time.step")

    def fields(self, motion):
        found = []
        for coefficients in motion[:2]:
            values = self.at_nodes.createVecLeft()
            self.at_nodes.mult(PETSc.Vec().createWithArray(np.ascontiguousarray(coefficients), comm=MPI.COMM_SELF), values)
            found.append(values.array.reshape(-1, 3).copy())
        return dict(zip(("displacement", "velocity"), found))

    def accept_step(self, step):
        self.motion, self.force, self.time, self.has_force = self.trial, self.trial_force, self.trial_time, True
        self.u0.x.array[:], self.v0.x.array[:] = self.motion[0], self.motion[1]
        return {name: (float(fem.assemble_scalar(form)), "J") for name, form in zip(("solid.kinetic_energy", "solid.strain_energy"), self.energy)}

    def write_checkpoint(self, path):
        with open(path, "wb") as file:
            np.savez(file, time=self.time, motion=self.motion, force=self.force)


if __name__ == "__main__":
    serve(Block)
