"""The one table of parameters: range, unit, default, label, explanation and source of every key.

Validation, sliders, hints, `--help` and the README's table come from here. Values are in the unit of the file
format (SI unless the key names another unit). The order of rows is the order of a dumped configuration.
`python -m model.config.parameters` prints the README's table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

Kind = Literal["number", "integer", "choice", "flag", "list", "text", "columns", "units", "points", "parts"]
Value = float | int | str | bool | tuple[Any, ...] | None  # tuples hold numbers, or roads that make up a sum

WHEEL_COUNT = (2, 20)  # road wheels a side; also the length of a list with one value for each
PART_LIMIT = 10  # roads in a sum
UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "km": 1e3, "ft": 0.3048, "in": 0.0254}  # of length, and its m
NOTED: tuple[Kind, ...] = ("text", "columns", "units")  # kinds that are noted beside a run and change nothing in it
STEEPEST = math.tan(math.radians(85))  # slope of a road's faces: none is steeper


@dataclass(frozen=True)
class Parameter:
    """One key of the configuration.

    `low` … `high` is what is allowed (of a list: each item; of a text: its length);
    `slider_low` … `slider_high` is the narrower stretch a slider offers. All in `unit`.
    """

    key: str  # dotted path, as in the file
    label: str
    symbol: str  # the paper's or model/MODEL.md's; empty where there is none
    unit: str
    default: Value  # None: computed from the others
    low: float = 0.0
    high: float = 0.0
    slider_low: float = 0.0
    slider_high: float = 0.0
    step: float = 0.0  # of the slider
    group: str = ""
    source: str = ""  # Table 1 | section 5 | assumed | this project
    description: str = ""
    growth: str = ""  # what happens when it grows; empty where nothing can grow
    kind: Kind = "number"
    choices: tuple[str, ...] = ()
    shown: tuple[str, float] | None = None  # friendlier unit, and the factor from `unit` to it
    roads: tuple[str, ...] = ()  # road types that have this key; empty: all of them
    optional: bool = False  # None is a value: the parameter is computed
    per_wheel: bool = False  # one number, or a list with one for each road wheel
    what_if: bool = False  # among the first sliders of the explorer

    @property
    def shown_unit(self) -> str:
        """Unit for people: "kN/m" where the file has N/m."""
        return self.shown[0] if self.shown else self.unit

    @property
    def shown_factor(self) -> float:
        """Value in `shown_unit` = value in the file × this."""
        return self.shown[1] if self.shown else 1.0

    @property
    def allowed(self) -> str:
        """What may be given, in words, with the unit."""
        reach = f"from {number_text(self.low)} to {number_text(self.high)}{self.unit and ' ' + self.unit}"
        words = {
            "number": f"a number {reach}",
            "integer": f"a whole number {reach}",
            "choice": "one of " + ", ".join(self.choices),
            "flag": "true or false",
            "list": f"a list of {WHEEL_COUNT[0]} to {WHEEL_COUNT[1]} numbers {reach}, front wheel first",
            "text": f"a text of at most {self.high:g} printable characters",
            "columns": "a list of one or two names or numbers of columns, such as [x, z]",
            "units": "units of x and y, such as {x: ft, y: in}, each one of " + ", ".join(UNITS),
            "points": "points x y, x y, … in m, x growing",
            "parts": f"a list of at most {PART_LIMIT} roads, each with its type and keys, none of them a sum",
        }[self.kind]
        return words + (", or a list of such numbers, front wheel first" if self.per_wheel else "")

    def slider(self, value: float) -> tuple[float, float, float]:
        """Ends and step of a slider for vehicles like the one with this value: a robot's are a tenth or less."""
        scale, least = 1.0, self.slider_low or self.slider_high / 100
        while 0.0 < value < scale * least:
            scale /= 10
        return max(scale * self.slider_low, self.low), scale * self.slider_high, scale * self.step

    def torsional(self) -> Parameter:
        """The same as a rate of the torsion spring itself; what is no rate at the wheel stays as it is."""
        if self.unit not in TORSIONAL:
            return self
        unit, shown = TORSIONAL[self.unit]
        description = self.description.replace(", at the wheel", "").replace(", at that wheel", "")
        return replace(self, unit=unit, shown=shown, description=description)

    def applies_to(self, road_type: str) -> bool:
        """Whether a configuration with this type of road has the key."""
        return not self.roads or road_type in self.roads


def number_text(value: float) -> str:
    """A number as people write it: 100000, 6e7, 0.0001."""
    if value == 0 or 1e-4 <= abs(value) < 1e6:
        return f"{value:.10g}"
    mantissa, exponent = f"{value:e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


PAPER_TABLE, PAPER_TEXT, ASSUMED, OURS = "Table 1", "section 5", "assumed", "this project"
SUSPENSION, TRACK, VEHICLE, CONTACT = "Suspension", "Track", "Vehicle", "Ground contact"
ROAD, DRIVE, SOLVER, NOTES = "Road", "Speed control", "Solver", "Notes"
GROUPS = (SUSPENSION, TRACK, VEHICLE, CONTACT, ROAD, DRIVE, SOLVER, NOTES)

INTEGRATORS = (
    "stretched-rk43", "dormand-prince", "rk4", "scipy-rk45", "scipy-dop853", "scipy-radau", "scipy-lsoda", "scipy-bdf",
)  # fmt: skip
ROADS = ("flat", "sine", "half_round", "trapezoid", "step", "random", "profile", "sum")
HULLS = ("turret", "carrier", "plain")
KILO_N_PER_M, KILO_N_S_PER_M, MILLIMETRES = ("kN/m", 1e-3), ("kN s/m", 1e-3), ("mm", 1e3)
# Unit of a rate at the wheel -> unit and shown unit of the rate about the joint
TORSIONAL: dict[str, tuple[str, tuple[str, float] | None]] = {
    "N/m": ("N m/rad", ("kN m/rad", 1e-3)),
    "N s/m": ("N m s/rad", ("kN m s/rad", 1e-3)),
    "1/m²": ("1/rad²", None),
}

# fmt: off
# Columns: key, label, symbol, unit, default, low, high, slider low, slider high, slider step
PARAMETERS: tuple[Parameter, ...] = (
    Parameter("name", "Name", "", "", "Paper vehicle", 0, 100,
        group=NOTES, source=OURS, kind="text",
        description="Title of this configuration."),
    Parameter("description", "Description", "", "", "", 0, 1000,
        group=NOTES, source=OURS, kind="text",
        description="What this configuration is, in a sentence or two."),

    Parameter("vehicle.chassis.mass", "Hull mass", "m_c", "kg", 5125.0, 1, 100000, 1000, 20000, 25,
        group=VEHICLE, source=PAPER_TABLE,
        description="Sprung mass carried by one side's wheels: half of the hull.",
        growth="Road wheels carry more, the imaginary wheels' share falls, and the hull bounces and pitches more "
        "slowly."),
    Parameter("vehicle.chassis.pitch_inertia", "Pitch inertia", "J_c", "kg m²", 14630.0, 0.001, 1e7, 2000, 60000, 10,
        group=VEHICLE, source=PAPER_TABLE,
        description="Moment of inertia of the half hull about its centre of mass.",
        growth="The hull pitches more slowly and for longer; on the paper's road it then pitches much further."),
    Parameter("vehicle.chassis.cg_height", "Centre of mass", "h_cg", "m", 0.95, 0.02, 5, 0.4, 2, 0.01,
        group=VEHICLE, source=ASSUMED,
        description="Height of the hull's centre of mass above flat ground in the design pose.",
        growth="Driving and braking forces tip the hull more, so it pitches further."),
    Parameter("vehicle.chassis.belly_height", "Belly", "", "m", None, 0.01, 5, 0.1, 1, 0.01,
        group=VEHICLE, source=OURS, shown=MILLIMETRES, optional=True,
        description="Height of the hull's floor above flat ground in the design pose; the motion does not depend on "
        "it, but a run warns where the floor would meet the ground. Left out: just under the road arms' pivots.",
        growth="Higher obstacles pass under the hull."),
    Parameter("vehicle.seat.x", "Seat, forward", "", "m", 1.5, -20, 20, -3, 3, 0.05,
        group=VEHICLE, source=ASSUMED,
        description="How far ahead of the hull's centre of mass the driver sits; the ride at the seat is judged there.",
        growth="The driver sits further forward and feels more of the hull's pitching."),
    Parameter("vehicle.seat.y", "Seat, up", "", "m", 0.1, -5, 5, -1, 2, 0.05,
        group=VEHICLE, source=ASSUMED,
        description="How far above the hull's centre of mass the driver sits.",
        growth="The driver sits higher: pitching shakes more fore and aft; up and down nothing changes."),
    Parameter("vehicle.road_wheels.count", "Road wheels", "n", "", 6, *WHEEL_COUNT, *WHEEL_COUNT, 1,
        group=VEHICLE, source=PAPER_TABLE, kind="integer",
        description="Number of road wheels on one side, evenly spaced.",
        growth="The vehicle gets longer, each wheel carries less, and the ride on waves gets smoother."),
    Parameter("vehicle.road_wheels.spacing", "Wheel spacing", "s", "m", 0.7, 0.05, 5, 0.4, 1.5, 0.005,
        group=VEHICLE, source=PAPER_TABLE,
        description="Distance between neighbouring road wheels; Table 1's wheel base of 3.5 m has five such gaps.",
        growth="The wheel base gets longer: on waves the hull heaves and pitches less."),
    Parameter("vehicle.road_wheels.offset", "Wheel offset", "", "m", 0.0, -50, 50, -1, 1, 0.01,
        group=VEHICLE, source=ASSUMED,
        description="How far the middle of the wheels lies ahead of the hull's centre of mass.",
        growth="The wheels move forward under the hull: front wheels carry less, rear wheels more."),
    Parameter("vehicle.road_wheels.positions", "Wheel positions", "x_i", "m", None, -50, 50,
        group=VEHICLE, source=OURS, kind="list", optional=True,
        description="Where each road wheel stands ahead of the centre of mass; left out: by count, spacing, offset."),
    Parameter("vehicle.road_wheels.radius", "Wheel radius", "r", "m", 0.32, 0.05, 2, 0.15, 0.6, 0.005,
        group=VEHICLE, source=PAPER_TABLE,
        description="Radius of road wheels and imaginary wheels.",
        growth="Obstacles and short waves hit less hard; on long waves nothing changes."),
    Parameter("vehicle.road_wheels.mass", "Wheel mass", "m_w", "kg", 75.0, 0.1, 5000, 10, 300, 1,
        group=VEHICLE, source=PAPER_TABLE,
        description="Mass of one road wheel.",
        growth="Each wheel presses harder on the ground, at rest and in its peaks; the hull's motion hardly changes."),
    Parameter("vehicle.road_wheels.inertia", "Wheel inertia", "J_w", "kg m²", None, 0.0001, 100000, 0.5, 20, 0.1,
        group=VEHICLE, source=ASSUMED, optional=True,
        description="Moment of inertia of one road wheel about its axle; left out: a uniform disc, m r²/2.",
        growth="Speed and drive force swing a little less; loads hardly change."),
    Parameter("vehicle.road_arms.length", "Road arm length", "L", "m", 0.35, 0.05, 3, 0.15, 0.8, 0.01,
        group=SUSPENSION, source=ASSUMED,
        description="From the pivot in the hull to the axle of the road wheel.",
        growth="The arm turns less for the same wheel travel; with rates given at the wheel the ride hardly changes."),
    Parameter("vehicle.road_arms.angle_deg", "Road arm angle", "φ", "°", 20.0, -60, 80, -20, 60, 1,
        group=SUSPENSION, source=ASSUMED,
        description="Angle below the horizontal at which the arm runs down and back from its pivot, in the design "
        "pose.",
        growth="The arm stands steeper; on the paper's road load peaks fall a little and the hull's acceleration "
        "rises."),
    Parameter("vehicle.road_arms.mass", "Road arm mass", "m_a", "kg", 30.0, 0.1, 5000, 1, 150, 1,
        group=SUSPENSION, source=ASSUMED,
        description="Mass of one road arm, its centre of mass half-way along.",
        growth="Each road wheel presses a little harder on the ground; the ride hardly changes."),
    Parameter("vehicle.road_arms.inertia", "Road arm inertia", "J_a", "kg m²", None, 0.0001, 100000, 0.05, 10, 0.05,
        group=SUSPENSION, source=ASSUMED, optional=True,
        description="Moment of inertia of one road arm about its centre of mass; left out: a uniform bar, m L²/12.",
        growth="Hardly anything changes: the arm is light beside its wheel."),
    Parameter("vehicle.road_suspension.basis", "Suspension rates", "", "", "wheel",
        group=SUSPENSION, source=OURS, kind="choice", choices=("wheel", "torsion"),
        description="wheel: stiffness and damping as felt at the wheel (N/m, N s/m), as Table 1 prints them; "
        "torsion: of the torsion bar itself (N m/rad, N m s/rad)."),
    Parameter("vehicle.road_suspension.stiffness", "Suspension stiffness", "k_s", "N/m", 75530.0,
        10, 1e8, 5000, 300000, 500,
        group=SUSPENSION, source=PAPER_TABLE, shown=KILO_N_PER_M, per_wheel=True, what_if=True,
        description="Stiffness of the torsion bar that holds each road arm, at the wheel.",
        growth="Wheel loads swing further, and bounce and pitch get faster, so that the hull is shaken more or "
        "less, depending on the waves."),
    Parameter("vehicle.road_suspension.damping", "Suspension damping", "c_s", "N s/m", 4732.0, 0, 1e7, 0, 30000, 100,
        group=SUSPENSION, source=PAPER_TABLE, shown=KILO_N_S_PER_M, per_wheel=True,
        what_if=True,
        description="Damping between hull and each road arm, at the wheel.",
        growth="Bounce and pitch die away sooner, but sharp obstacles hit the hull harder."),
    Parameter("vehicle.road_suspension.progression", "Progression", "p", "1/m²", 0.0, 0, 10000, 0, 200, 1,
        group=SUSPENSION, source=OURS,
        description="How much the spring stiffens with its deflection z from the design pose: its force is "
        "k_s z (1 + p z²); 0 is the paper's linear spring.",
        growth="Large deflections meet a harder spring, so that arms turn less far; small ones feel no difference."),
    Parameter("vehicle.road_suspension.rebound_ratio", "Rebound ratio", "", "", 1.0, 0, 20, 0, 5, 0.05,
        group=SUSPENSION, source=OURS,
        description="Damping while a wheel moves down in the hull, as a multiple of the damping while it moves up; "
        "1 is the paper's damper.",
        growth="Wheels fall into dips more slowly and the hull is drawn down over a row of bumps."),
    Parameter("vehicle.road_suspension.bump_travel", "Bump stop at", "", "m", None, 0.01, 2, 0.03, 0.4, 0.005,
        group=SUSPENSION, source=OURS, shown=MILLIMETRES, optional=True,
        description="Travel of a wheel upwards in the hull, from the design pose, at which its arm meets the bump "
        "stop; left out: no stop, as in the paper.",
        growth="Wheels can rise further before the stop hits the hull."),
    Parameter("vehicle.road_suspension.rebound_travel", "Rebound stop at", "", "m", None, 0.01, 2, 0.03, 0.4, 0.005,
        group=SUSPENSION, source=OURS, shown=MILLIMETRES, optional=True,
        description="Travel of a wheel downwards in the hull, from the design pose, at which its arm meets the "
        "rebound stop; left out: no stop, as in the paper.",
        growth="Wheels can follow the ground further down before they are held."),
    Parameter("vehicle.road_suspension.stop_stiffness", "Stop stiffness", "", "N/m", 5e5, 100, 1e9, 1e4, 5e6, 1e4,
        group=SUSPENSION, source=ASSUMED, shown=KILO_N_PER_M,
        description="Stiffness of both stops, at the wheel, on top of the spring.",
        growth="A stop gives way less and hits harder."),
    Parameter("vehicle.road_suspension.stop_damping", "Stop damping", "", "N s/m", 1e4, 0, 1e7, 0, 1e5, 500,
        group=SUSPENSION, source=ASSUMED, shown=KILO_N_S_PER_M,
        description="Damping of both stops, at the wheel; a stop never pulls.",
        growth="A stop throws the wheel back less, and its first blow is harder."),
    Parameter("vehicle.imaginary_wheels.enabled", "Imaginary wheels", "", "", True,
        group=TRACK, source=OURS, kind="flag",
        description="Whether imaginary wheels stand in for the track; without them only road wheels carry."),
    Parameter("vehicle.imaginary_wheels.mass", "Imaginary mass", "", "kg", 75.0, 0.1, 5000, 5, 300, 1,
        group=TRACK, source=PAPER_TABLE,
        description="Mass of one imaginary wheel (as large as a road wheel).",
        growth="More weight rests on the imaginary wheels, and they leave the ground less."),
    Parameter("vehicle.imaginary_wheels.inertia", "Imaginary inertia", "", "kg m²", None, 0.0001, 100000, 0.5, 20, 0.1,
        group=TRACK, source=ASSUMED, optional=True,
        description="Moment of inertia of one imaginary wheel about its axle; left out: a uniform disc, m r²/2.",
        growth="Speed and drive force swing a little less; loads hardly change."),
    Parameter("vehicle.imaginary_arms.mass", "Link mass", "", "kg", 5.0, 0.001, 1000, 1, 50, 0.5,
        group=TRACK, source=ASSUMED,
        description="Mass of the link from a road wheel to the imaginary wheel behind it.",
        growth="A little more weight rests on the ground with each imaginary wheel."),
    Parameter("vehicle.imaginary_suspension.basis", "Imaginary rates", "", "", "wheel",
        group=TRACK, source=OURS, kind="choice", choices=("wheel", "torsion"),
        description="wheel: stiffness and damping as felt at the imaginary wheel (N/m, N s/m), as Table 1 prints "
        "them; torsion: of the torsion spring itself (N m/rad, N m s/rad)."),
    Parameter("vehicle.imaginary_suspension.stiffness", "Imaginary stiffness", "k_sl", "N/m", 1e4,
        10, 1e8, 500, 50000, 500, group=TRACK, source=PAPER_TABLE, shown=KILO_N_PER_M, what_if=True,
        description="Stiffness of the spring that presses an imaginary wheel to the ground, at that wheel.",
        growth="Imaginary wheels carry a larger share of the load; the hull's acceleration hardly changes up to "
        "about three times the paper's value, then grows."),
    Parameter("vehicle.imaginary_suspension.damping", "Imaginary damping", "c_sl", "N s/m", 5000.0,
        0, 1e7, 0, 20000, 100, group=TRACK, source=PAPER_TABLE, shown=KILO_N_S_PER_M,
        description="Damping of the imaginary wheel's spring, at that wheel.",
        growth="Pitching dies away sooner and peaks of acceleration fall, but imaginary wheels are off the ground "
        "for longer."),
    Parameter("vehicle.imaginary_suspension.preload_deflection", "Track preload", "δ", "m", 0.1, 0, 1, 0, 0.3, 0.005,
        group=TRACK, source=ASSUMED, shown=MILLIMETRES,
        description="How far the imaginary spring is wound up in the design pose, at the wheel: a stiffer one "
        "presses harder.",
        growth="Imaginary wheels carry more of the weight, road wheels less."),
    Parameter("vehicle.imaginary_suspension.preload_force", "Preload force", "T", "N", None, 0, 1e6, 0, 10000, 50,
        group=TRACK, source=OURS, shown=("kN", 1e-3), optional=True,
        description="Preload of the imaginary spring as a force at the wheel; left out: by the preload deflection.",
        growth="Imaginary wheels carry more of the weight, road wheels less."),
    Parameter("vehicle.imaginary_suspension.reacts_on", "Reacts on", "", "", "road_arm",
        group=TRACK, source=OURS, kind="choice", choices=("road_arm", "chassis"),
        description="Which body the imaginary spring leans on: road_arm (the paper's model) or chassis."),
    Parameter("vehicle.hull", "Hull shape", "", "", "turret",
        group=VEHICLE, source=OURS, kind="choice", choices=HULLS,
        description="Shape in which the hull is drawn; nothing is computed from it. turret: low, with a turret and a "
        "gun; carrier: a box with a sloped front; plain: flat, as of a robot."),

    Parameter("contact.normal_stiffness", "Ground stiffness", "k_n", "N/m²", 6e7, 1e6, 1e10, 1e6, 2e8, 1e6,
        group=CONTACT, source=ASSUMED, shown=("MN/m²", 1e-6),
        description="Normal force per square of the wheel's penetration into the ground.",
        growth="Wheels sink in less; loads and ride hardly change."),
    Parameter("contact.normal_damping", "Ground damping", "c_n", "N s/m³", 3e7, 0, 1e10, 0, 2e8, 1e6,
        group=CONTACT, source=ASSUMED, shown=("MN s/m³", 1e-6),
        description="Resistance to sinking in quickly; it grows with the square of the penetration.",
        growth="Wheels that land bounce less, but very large values make their load peaks higher; on smooth roads "
        "nothing changes."),
    Parameter("contact.tangential_stiffness", "Shear stiffness", "k_t", "N/m", 5e5, 1000, 1e9, 50000, 5e6, 50000,
        group=CONTACT, source=ASSUMED, shown=KILO_N_PER_M,
        description="Stiffness of the ground along the road under a wheel that sticks.",
        growth="The ground gives way less under traction; loads and ride hardly change."),
    Parameter("contact.tangential_damping", "Shear damping", "c_t", "N s/m", 1e4, 1, 1e8, 1000, 100000, 1000,
        group=CONTACT, source=ASSUMED, shown=KILO_N_S_PER_M,
        description="Damping of the ground along the road under a wheel that sticks.",
        growth="Loads and ride hardly change; very large values make the solver take many more steps."),
    Parameter("contact.friction", "Friction", "μ", "", 0.7, 0, 2, 0, 1.5, 0.01,
        group=CONTACT, source=ASSUMED,
        description="Largest traction as a share of the normal load.",
        growth="Wheels can pull and brake harder before they slip; beyond what the road asks for, nothing changes."),

    Parameter("drive.mode", "Speed kept by", "", "", "cruise",
        group=DRIVE, source=PAPER_TEXT, kind="choice", choices=("cruise", "prescribed"),
        description="cruise: a controller drives the wheels, each in proportion to its load; prescribed: the hull "
        "is pulled along at constant speed by a force at its centre of mass, not through the wheels, and so pitches "
        "differently."),
    Parameter("drive.speed_kmh", "Speed", "v_ref", "km/h", 15.0, 0.5, 100, 2, 70, 0.5,
        group=DRIVE, source=PAPER_TEXT, what_if=True,
        description="Speed to be kept.",
        growth="The same waves shake the vehicle more often a second, worst where that meets its bounce or pitch "
        "frequency; wheels leave the ground behind crests."),
    Parameter("drive.proportional_gain", "Speed gain", "K_p", "N s/m", 20000.0, 0, 1e7, 0, 100000, 500,
        group=DRIVE, source=ASSUMED,
        description="Drive force for each m/s that the vehicle is too slow (cruise).",
        growth="The speed is kept more tightly, with larger swings of the drive force."),
    Parameter("drive.integral_gain", "Speed trim", "K_i", "N/m", 1e4, 0, 1e7, 0, 100000, 500,
        group=DRIVE, source=ASSUMED,
        description="How fast the drive force grows while the vehicle stays too slow (cruise).",
        growth="A lasting lack of speed is made up sooner; too much makes speed and drive force swing further."),
    Parameter("drive.force_limit", "Force limit", "F_max", "N", 40000.0, 0, 1e7, 0, 100000, 1000,
        group=DRIVE, source=ASSUMED, shown=("kN", 1e-3),
        description="Largest drive or braking force (cruise).",
        growth="Steeper roads can be climbed without losing speed."),

    Parameter("road.type", "Road type", "", "", "sine",
        group=ROAD, source=PAPER_TEXT, kind="choice", choices=ROADS,
        description="flat: level ground; sine: waves without end; half_round, trapezoid: one obstacle on level "
        "ground; step: a kerb up to a higher level; random: rough ground of a class of ISO 8608; profile: measured "
        "points; sum: several roads on top of each other."),
    Parameter("road.amplitude", "Amplitude", "A", "m", 0.1, 0, 0.5, 0, 0.3, 0.005,
        group=ROAD, source=PAPER_TEXT, shown=MILLIMETRES, roads=("sine",), what_if=True,
        description="Height of a crest above the mean of the road (the paper's 100 mm).",
        growth="Hull and loads swing further, in proportion at first, until wheels leave the ground."),
    Parameter("road.wavelength", "Wavelength", "λ", "m", 7.0, 0.3, 200, 0.5, 20, 0.1,
        group=ROAD, source=PAPER_TEXT, roads=("sine",), what_if=True,
        description="Distance from crest to crest.",
        growth="Waves longer than the vehicle lift it more gently, as a whole; worst are those that meet its bounce "
        "or pitch frequency."),
    Parameter("road.position", "Obstacle at", "", "m", 4.0, -50, 10000, 2, 50, 0.1,
        group=ROAD, source=OURS, roads=("half_round", "trapezoid", "step"),
        description="Where the middle of the obstacle lies, or a step's foot, ahead of the centre of mass at the "
        "start.",
        growth="The vehicle meets the obstacle later."),
    Parameter("road.height", "Obstacle height", "", "m", 0.1, 0.001, 2, 0.02, 0.4, 0.01,
        group=ROAD, source=OURS, shown=MILLIMETRES, roads=("half_round", "trapezoid", "step"),
        description="Height of the obstacle's top above the ground.",
        growth="Wheels and hull are thrown up harder."),
    Parameter("road.radius", "Obstacle radius", "", "m", 0.2, 0.01, 20, 0.05, 2, 0.01,
        group=ROAD, source=OURS, roads=("half_round",),
        description="Radius of the circle whose part above ground is the obstacle: at least its height.",
        growth="At the same height the obstacle is longer and its edges are flatter: loads peak lower."),
    Parameter("road.top", "Length of top", "", "m", 0.5, 0.01, 1000, 0.1, 10, 0.1,
        group=ROAD, source=OURS, roads=("trapezoid",),
        description="Length of the trapezoid's level top.",
        growth="The vehicle stays up for longer; what it goes through at either face is further apart."),
    Parameter("road.base", "Length of base", "", "m", 1.5, 0.01, 2000, 0.1, 20, 0.1,
        group=ROAD, source=OURS, roads=("trapezoid",),
        description="Length of the trapezoid on the ground, at least that of its top; its faces are never steeper "
        "than 85°.",
        growth="The faces are less steep: loads peak lower."),
    Parameter("road.roughness_class", "Roughness class", "", "", "C",
        group=ROAD, source=OURS, roads=("random",), kind="choice", choices=tuple("ABCDEFGH"),
        description="Class of ISO 8608: A is a very good road, B a good one, C an average one, D a poor one, E a very "
        "poor one; F, G and H are ground without a road. Heights double from class to class."),
    Parameter("road.seed", "Seed", "", "", 1, 0, 999999, 0, 1000, 1,
        group=ROAD, source=OURS, roads=("random",), kind="integer",
        description="Number of the random road: the same number gives the same road anywhere.",
        growth="It is another road of the same roughness."),
    Parameter("road.length", "Repeats after", "", "m", 200.0, 20, 10000, 20, 1000, 10,
        group=ROAD, source=OURS, roads=("random",),
        description="Length of random road, after which it repeats itself.",
        growth="It takes longer until the same bumps come again; it is another road of the same roughness."),
    Parameter("road.longest_wave", "Longest wave", "", "m", 20.0, 20, 90, 20, 90, 5,
        group=ROAD, source=OURS, roads=("random",),
        description="Longest waves of the random road; none is longer than the length after which it repeats itself. "
        "Shorter waves stay as they are. At speed, a hull pitches on long waves, too: above about 50 km/h give more "
        "than 20 m.",
        growth="Longer and higher waves come in: at speed the hull pitches more, loads hardly change."),
    Parameter("road.file", "Profile file", "", "", "", 0, 500,
        group=ROAD, source=OURS, roads=("profile",), kind="text",
        description="File of the profile: a table of text with columns of x and y (CSV and the like), ERD or OpenCRG; "
        "found from the folder of the configuration that names it. Beside points it only says where these came from."),
    Parameter("road.columns", "Columns", "", "", (),
        group=ROAD, source=OURS, roads=("profile",), kind="columns",
        description="Columns of the file that hold x and y, or y alone, by name or by number from 1; of OpenCRG, v=0.9 "
        "is the line at v = 0.9 m. Left out: those that the headings name; the first channel of ERD, the middle of "
        "OpenCRG."),
    Parameter("road.units", "Units", "", "", (),
        group=ROAD, source=OURS, roads=("profile",), kind="units",
        description="Units of x and y in the file, such as {x: ft, y: in}: m, mm, cm, dm, km, ft or in. Left out: what "
        "its headings say, else m."),
    Parameter("road.points", "Profile", "", "", "0 0, 6 0, 7 0.1, 8 0.05, 10 0.05",
        group=ROAD, source=OURS, roads=("profile",), kind="points",
        description="The profile itself: x y, x y, … in m, at most 200001 points; what the file says, once it has "
        "been read."),
    Parameter("road.parts", "Parts", "", "", (),
        group=ROAD, source=OURS, roads=("sum",), kind="parts",
        description="The roads whose heights are added up: a list, each with its type and keys."),
    Parameter("road.start", "Start of road", "x_s", "m", None, -50, 1000, 2, 50, 0.1,
        group=ROAD, source=OURS, roads=("sine", "profile"), optional=True,
        description="Where the waves begin, ahead of the centre of mass at the start, or the profile's first point "
        "lies, at ground level. Left out: 1 m ahead of the first wheel; for a profile, where its points say, "
        "unless they begin beyond 1000 m.",
        growth="The vehicle drives on level ground for longer."),
    Parameter("road.ramp", "Run-in", "ℓ", "m", None, 0, 1000, 0.5, 50, 0.1,
        group=ROAD, source=OURS, roads=("sine", "step"), optional=True,
        description="Stretch over which the waves grow to their full height, or a step rises. Left out: one "
        "wavelength; for a step, as steep as a face can be, 85°.",
        growth="The waves, or the step, set in more gently."),

    Parameter("simulation.duration", "Duration", "", "s", 10.0, 0.1, 600, 1, 60, 0.5,
        group=SOLVER, source=OURS,
        description="How much time is simulated.",
        growth="The run covers more road and takes longer to compute."),
    Parameter("simulation.output_rate", "Output rate", "", "1/s", 200.0, 10, 2000, 50, 1000, 10,
        group=SOLVER, source=OURS,
        description="Stored samples for each second.",
        growth="Short peaks show more fully; files get larger. The motion stays the same."),
    Parameter("simulation.integrator", "Integrator", "", "", "stretched-rk43",
        group=SOLVER, source=OURS, kind="choice", choices=INTEGRATORS,
        description="stretched-rk43: order 4(3), chooses its own steps, longer ones than others in the stiff contacts; "
        "dormand-prince: order 5(4), chooses its own steps; rk4: order 4, fixed step; scipy-…: SciPy's methods, "
        "slower, for comparison."),
    Parameter("simulation.step", "Fixed step", "h", "s", 0.001, 1e-6, 0.1, 0.0001, 0.005, 0.0001,
        group=SOLVER, source=OURS, shown=("ms", 1000),
        description="Step of the rk4 integrator; the others choose their own.",
        growth="Fewer steps and a coarser result; from about 8 ms the motion of the paper's vehicle blows up."),
    Parameter("simulation.rtol", "Relative tolerance", "", "", 0.0001, 1e-12, 0.1, 1e-8, 0.01, 1e-8,
        group=SOLVER, source=OURS,
        description="Error allowed in a step, relative to the state's size, and in proportion to rough motion.",
        growth="Fewer steps and a coarser result."),
    Parameter("simulation.atol", "Absolute tolerance", "", "", 1e-6, 1e-14, 0.1, 1e-10, 0.001, 1e-10,
        group=SOLVER, source=OURS,
        description="Error allowed in a step where the state is near zero (m, rad, m/s, rad/s).",
        growth="Fewer steps and a coarser result."),
    Parameter("simulation.baumgarte_alpha", "Drift damping", "α", "1/s", 20.0, 0, 1000, 0, 100, 1,
        group=SOLVER, source=OURS,
        description="Baumgarte's α: damps velocity errors of the joints.",
        growth="Joints that move apart are stopped faster; from 5 to 100 the motion is the same."),
    Parameter("simulation.baumgarte_beta", "Drift stiffness", "β", "1/s", 20.0, 0, 1000, 0, 100, 1,
        group=SOLVER, source=OURS,
        description="Baumgarte's β: pulls the joints back together.",
        growth="Joints that have moved apart close faster; from 5 to 100 the motion is the same."),
)
# fmt: on

PARAMETER: dict[str, Parameter] = {parameter.key: parameter for parameter in PARAMETERS}
SECTIONS: frozenset[str] = frozenset(
    key[:dot] for key in PARAMETER for dot, character in enumerate(key) if character == "."
)


def parameter_table() -> str:
    """The README's table of parameters, in Markdown."""
    rows = [
        "| Key | Symbol | Default | Allowed | What it is | From |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for parameter in PARAMETERS:
        default = parameter.default
        match default:
            case None:
                shown = "–"
            case bool():
                shown = str(default).lower()
            case tuple():
                shown = "none"
            case float() | int():
                shown = f"{number_text(default)} {parameter.unit}".strip()
            case _:
                shown = str(default) or "–"
        cells = [f"`{parameter.key}`", parameter.symbol, shown, parameter.allowed]
        cells += [parameter.description, parameter.source]
        rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows)


if __name__ == "__main__":
    print(parameter_table())
