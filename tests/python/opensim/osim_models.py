# SPDX-License-Identifier: Apache-2.0
"""Small OpenSim models, built through OpenSim's own interface, in general poses."""

import numpy as np


class Builder:
    """A model in the making; hands what it makes to OpenSim, which then owns it."""

    def __init__(self, osim, name):
        self.osim, self.model = osim, osim.Model()
        self.model.setName(name)
        self.model.set_gravity(osim.Vec3(0.3, -9.7, 0.2))
        self._kept = []

    def owned(self, thing):
        thing.this.disown()
        self._kept.append(thing)
        return thing

    def vec(self, *xyz):
        return self.osim.Vec3(*xyz)

    def body(self, name, mass=1.7):
        inertia = self.osim.Inertia(0.11, 0.12, 0.13, 0.011, 0.012, 0.013)
        body = self.osim.Body(name, mass, self.vec(0.02, -0.13, 0.04), inertia)
        self.model.addBody(self.owned(body))
        return body

    def joint(self, kind, name, parent, child, *extra):
        """A joint between frames that stand askew in both bodies."""
        frames = (
            parent, self.vec(0.05, -0.21, 0.03), self.vec(0.3, -0.2, 0.4),
            child, self.vec(0.01, 0.17, -0.02), self.vec(-0.1, 0.25, 0.15),
        )  # fmt: skip
        joint = getattr(self.osim, kind)(name, *frames, *extra)
        self.model.addJoint(self.owned(joint))
        return joint

    def spline(self, kind, x, y):
        function = getattr(self.osim, kind)()
        for at, value in zip(x, y, strict=True):
            function.addPoint(at, value)
        return self.owned(function)

    def polynomial(self, *highest_first):
        vector = self.osim.Vector(len(highest_first), 0.0)
        for i, value in enumerate(highest_first):
            vector.set(i, value)
        return self.owned(self.osim.PolynomialFunction(vector))

    def linear(self, slope, intercept):
        return self.owned(self.osim.LinearFunction(slope, intercept))

    def constant(self, value):
        return self.owned(self.osim.Constant(value))

    def times(self, factor, function):
        return self.owned(self.osim.MultiplierFunction(function, factor))

    def transform(self, *axes):
        """SpatialTransform of six (axis, coordinates, function)."""
        transform = self.osim.SpatialTransform()
        for i, (axis, coordinates, function) in enumerate(axes):
            one = transform.updTransformAxis(i)
            names = self.osim.ArrayStr()
            for name in coordinates:
                names.append(name)
            one.setCoordinateNames(names)
            one.setAxis(self.vec(*axis))
            one.setFunction(function)
        return transform

    def muscle(self, kind, name, *points):
        muscle = getattr(self.osim, kind)()
        muscle.setName(name)
        muscle.set_max_isometric_force(812.0)
        muscle.set_optimal_fiber_length(0.091)
        muscle.set_tendon_slack_length(0.137)
        muscle.set_pennation_angle_at_optimal(0.21)
        muscle.set_max_contraction_velocity(11.5)
        return self.along(muscle, points)

    def along(self, force, points):
        for i, (body, xyz) in enumerate(points):
            force.updGeometryPath().appendNewPathPoint(
                f"{force.getName()}_{i}", body, self.vec(*xyz)
            )
        self.model.addForce(self.owned(force))
        return force

    def wrap(self, body, wrap, name, **properties):
        wrap.setName(name)
        wrap.set_xyz_body_rotation(self.vec(0.2, -0.3, 0.1))
        for key, value in properties.items():
            getattr(wrap, f"set_{key}")(value)
        body.addWrapObject(self.owned(wrap))
        return wrap

    def write(self, file):
        self.model.finalizeConnections()
        self.model.printToXML(str(file))
        return file


def chain_of_plain_joints(osim, file):
    """Every joint that has no functions, one after the other."""
    build = Builder(osim, "chain")
    parent = build.model.getGround()
    kinds = ("Free", "Pin", "Ball", "Slider", "Universal", "Weld", "Planar", "Gimbal")
    for kind in kinds:
        child = build.body(f"body_{kind.lower()}")
        build.joint(f"{kind}Joint", f"{kind.lower()}_joint", parent, child)
        parent = child
    return build.write(file)


def leg(osim, file):
    """A leg: splined knee, coupled patella, muscles, ligaments, wraps, springs, and what does not fit."""
    build = Builder(osim, "leg")
    ground = build.model.getGround()
    pelvis, thigh, shank, patella = (build.body(n) for n in ("pelvis", "thigh", "shank", "patella"))
    build.joint("WeldJoint", "sit", ground, pelvis)
    build.joint("PinJoint", "hip", pelvis, thigh).updCoordinate().setName("hip_flex")
    knots = (-0.4, 0.1, 0.7, 1.3, 2.2)
    knee = build.transform(
        ((0.1, 0.2, -1.0), ["knee_flex"], build.linear(-1.1, 0.07)),
        ((1.0, 0.1, 0.0), ["knee_flex"], build.spline("SimmSpline", knots, (0.0, 0.02, 0.06, 0.02, 0.05))),
        ((0.0, 1.0, 0.3), ["knee_rot"], build.polynomial(0.3, -0.2, 0.9, 0.01)),
        ((1.0, 0.0, 0.2), ["knee_flex"], build.times(0.02, build.spline("SimmSpline", knots, (1, 3, 2, 4, 1)))),
        ((0.0, 2.0, 0.0), ["knee_shift"], build.linear(1.0, 0.003)),
        ((0.0, 0.0, 1.0), ["knee_flex"], build.spline("PiecewiseLinearFunction", knots, (0.0, 0.01, 0.0, -0.01, 0.02))),
    )  # fmt: skip
    build.joint("CustomJoint", "knee", thigh, shank, knee)
    glide = build.transform(
        ((0.0, 0.0, 1.0), ["pf_flex"], build.linear(1.0, 0.0)),
        ((0.0, 1.0, 0.0), [], build.constant(0.03)),
        ((1.0, 0.0, 0.0), [], build.constant(0.0)),
        ((1.0, 0.0, 0.0), ["pf_flex"], build.linear(0.02, 0.05)),
        ((0.0, 1.0, 0.0), [], build.constant(-0.01)),
        ((0.0, 0.0, 1.0), [], build.constant(0.0)),
    )
    build.joint("CustomJoint", "patellofemoral", thigh, patella, glide)
    _limit_coordinates(build)
    _add_forces(build, pelvis, thigh, shank, patella)
    _add_markers(build, (pelvis, thigh, shank))
    return build.write(file)


def oddities(osim, file):
    """What a model file has no words for, and contact of JAM's kind."""
    build = Builder(osim, "oddities")
    ground = build.model.getGround()
    first, second, third = (build.body(name) for name in ("first", "second", "third"))
    build.joint("EllipsoidJoint", "egg", ground, first, build.vec(0.1, 0.2, 0.3))
    axes = [((1.0, 0.0, 0.0), ["swing"], build.linear(1.0, 0.0))]
    axes += [
        ((0.0, 1.0, 0.0), [], build.constant(0.01)),
        ((0.0, 0.0, 1.0), [], build.constant(0.01)),
    ]
    axes += [((1.0, 0.0, 0.0), ["swing"], build.owned(osim.StepFunction(0.0, 1.0, 0.02, 0.05)))]
    axes += [
        ((0.0, 1.0, 0.0), [], build.constant(0.01)),
        ((0.0, 0.0, 1.0), [], build.constant(0.01)),
    ]
    swing = build.joint("CustomJoint", "stepping", ground, second, build.transform(*axes))
    swing.upd_coordinates(0).setDefaultValue(0.4)
    swing.upd_coordinates(0).setPrescribedFunction(build.linear(1.0, 0.4))
    swing.upd_coordinates(0).setDefaultIsPrescribed(True)
    build.joint("FreeJoint", "loose", ground, third)
    build.joint("BallJoint", "closing", second, third)
    build.write(file)
    text = file.read_text(encoding="utf-8")
    where = text.index("</Model>")
    file.write_text(text[:where] + JAM_CONTACT + text[where:], encoding="utf-8")
    return file


JAM_CONTACT = """
<ComponentSet name="componentset"><objects><FutureSpring name="from_tomorrow"/></objects></ComponentSet>
<ForceSet name="forceset"><objects>
 <Smith2018ArticularContactForce name="touch">
  <socket_target_mesh>/contactgeometryset/upper</socket_target_mesh>
  <socket_casting_mesh>/contactgeometryset/lower</socket_casting_mesh>
  <elastic_foundation_formulation>nonlinear</elastic_foundation_formulation>
  <use_lumped_contact_model>false</use_lumped_contact_model>
 </Smith2018ArticularContactForce>
</objects></ForceSet>
<ContactGeometrySet name="contactgeometryset"><objects>
 <Smith2018ContactMesh name="upper"><socket_frame>/bodyset/first</socket_frame>
  <mesh_file>upper.stl</mesh_file><elastic_modulus>3e6</elastic_modulus><thickness>0.004</thickness>
  <scale_factors>1 2 1</scale_factors></Smith2018ContactMesh>
 <Smith2018ContactMesh name="lower"><socket_frame>/bodyset/second</socket_frame>
  <mesh_file>lower.stl</mesh_file><elastic_modulus>5e6</elastic_modulus><poissons_ratio>0.4</poissons_ratio>
 </Smith2018ContactMesh>
</objects></ContactGeometrySet>
"""


def _limit_coordinates(build):
    for coordinate in build.model.updCoordinateSet():
        coordinate.setRangeMin(-0.35)
        coordinate.setRangeMax(1.4)
    build.model.updCoordinateSet().get("knee_flex").setDefaultValue(0.35)
    build.model.updCoordinateSet().get("knee_rot").setDefaultLocked(True)
    coupler = build.osim.CoordinateCouplerConstraint()
    coupler.setName("patella_follows")
    names = build.osim.ArrayStr()
    names.append("knee_flex")
    coupler.setIndependentCoordinateNames(names)
    coupler.setDependentCoordinateName("pf_flex")
    coupler.setFunction(build.spline("SimmSpline", (-0.5, 0.3, 0.8, 2.0), (-0.2, 0.3, 0.5, 1.6)))
    factor = coupler.updPropertyByName("scale_factor")
    build.osim.PropertyHelper.setValueDouble(1.1, factor)
    build.model.addConstraint(build.owned(coupler))
    pin = build.osim.PointConstraint()
    pin.setName("held")
    pin.set_isEnforced(False)
    pin.connectSocket_body_1(build.model.getBodySet().get("pelvis"))
    pin.connectSocket_body_2(build.model.getGround())
    build.model.addConstraint(build.owned(pin))


def _add_forces(build, pelvis, thigh, shank, patella):
    osim, vec = build.osim, build.vec
    build.wrap(thigh, osim.WrapCylinder(), "condyles",
               radius=0.021, length=0.2, quadrant="+x", translation=vec(0.01, -0.21, 0.0))  # fmt: skip
    build.wrap(thigh, osim.WrapSphere(), "head", radius=0.065, translation=vec(0.01, 0.17, -0.02))
    build.wrap(shank, osim.WrapSphere(), "head", radius=0.01)  # OpenSim takes the first of a name
    build.wrap(shank, osim.WrapEllipsoid(), "plateau",
               dimensions=vec(0.09, 0.1, 0.08), translation=vec(0.01, 0.17, -0.02))  # fmt: skip
    build.wrap(pelvis, osim.WrapTorus(), "ring",
               inner_radius=0.012, outer_radius=0.05, translation=vec(0.08, -0.1, 0.05))  # fmt: skip
    build.muscle(
        "Millard2012EquilibriumMuscle",
        "plain",
        (pelvis, (0.1, 0.02, 0.03)),
        (thigh, (0.03, -0.1, 0.02)),
    )
    bent = build.muscle(
        "Thelen2003Muscle", "bent", (thigh, (0.05, 0.02, 0.03)), (shank, (0.03, -0.1, 0.02))
    )
    conditional = osim.ConditionalPathPoint()
    conditional.setName("from_20_degrees")
    conditional.setParentFrame(thigh)
    conditional.setCoordinate(build.model.getCoordinateSet().get("knee_flex"))
    conditional.setRangeMin(0.35)
    conditional.setRangeMax(1.2)
    conditional.setLocation(vec(0.06, -0.2, 0.01))
    _insert(build, bent, conditional)
    moving = osim.MovingPathPoint()
    moving.setName("gliding")
    moving.setParentFrame(shank)
    coordinate = build.model.getCoordinateSet().get("knee_flex")
    for axis in "XYZ":
        getattr(moving, f"set{axis}Coordinate")(coordinate)
    moving.set_x_location(build.spline("SimmSpline", (-0.4, 0.5, 1.5), (0.03, 0.04, 0.02)))
    moving.set_y_location(build.linear(0.01, 0.02))
    moving.set_z_location(build.constant(0.017))
    _insert(build, bent, moving)
    around = build.muscle(
        "DeGrooteFregly2016Muscle",
        "around",
        (thigh, (0.09, -0.06, 0.03)),
        (shank, (0.06, 0.03, -0.02)),
    )
    around.updGeometryPath().addPathWrap(shank.getWrapObject("plateau"))
    ball = build.muscle(
        "Thelen2003Muscle", "over_ball", (pelvis, (0.08, -0.12, 0.04)), (thigh, (0.05, 0.05, -0.01))
    )
    ball.updGeometryPath().addPathWrap(thigh.getWrapObject("head"))
    through = build.muscle(
        "Thelen2003Muscle",
        "through_ring",
        (pelvis, (0.09, -0.05, -0.02)),
        (thigh, (0.06, 0.05, 0.04)),
    )
    through.updGeometryPath().addPathWrap(pelvis.getWrapObject("ring"))
    post = build.muscle(
        "Thelen2003Muscle", "over_post", (thigh, (-0.05, 0.0, 0.0)), (shank, (-0.05, -0.1, 0.01))
    )
    post.updGeometryPath().addPathWrap(thigh.getWrapObject("condyles"))
    for name, points in (
        ("strand", ((thigh, (0.02, -0.2, 0.03)), (shank, (0.02, 0.1, 0.04)))),
        ("wrapped_strand", ((thigh, (0.06, -0.2, 0.01)), (shank, (0.06, -0.03, 0.02)))),
    ):
        build.along(osim.Blankevoort1991Ligament(name, 2345.0, 0.043), points)
    build.along(
        osim.PathSpring("tendon", 0.051, 1.187e6, 0.0),
        ((patella, (0.01, 0.0, 0.0)), (shank, (0.04, 0.05, 0.0))),
    )
    _add_loose_forces(build)


def _insert(build, muscle, point):
    """Between the first and the last point."""
    build.owned(point)
    points = muscle.updGeometryPath().updPathPointSet()
    points.insert(points.getSize() - 1, point)


def _add_loose_forces(build):
    osim = build.osim
    spring = osim.SpringGeneralizedForce("knee_shift")
    spring.setName("shift_spring")
    spring.setStiffness(321.0)
    spring.setRestLength(0.012)
    spring.setViscosity(0.45)
    build.model.addForce(build.owned(spring))
    limit = osim.CoordinateLimitForce("knee_flex", 1.2, 20.0, -0.2, 21.0, 0.1, 0.2)
    limit.setName("knee_stop")
    build.model.addForce(build.owned(limit))
    torque = osim.CoordinateActuator("hip_flex")
    torque.setName("hip_motor")
    build.model.addForce(build.owned(torque))


def _add_markers(build, bodies):
    rng = np.random.default_rng(5)
    for body in bodies:
        for i in range(4):
            at = build.vec(*rng.uniform(-0.2, 0.2, 3))
            marker = build.osim.Marker(f"{body.getName()}_{i}", body, at)
            build.model.addMarker(build.owned(marker))
