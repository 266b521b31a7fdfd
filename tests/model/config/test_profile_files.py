"""Files of measured roads: what each means, or why it is refused."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from model.config.config import ConfigError
from model.config.config_files import read_profile
from model.config.profile_files import Reading, open_profile_file, read_profile_file
from model.config.profile_points import POINT_LIMIT, PointsError, points, points_text

FIELD = Path(__file__).parents[2] / "field"


def read(text: str | bytes, **how: list[str]) -> tuple[list[float], list[float]]:
    x, y = points(read_profile_file(text.encode() if isinstance(text, str) else text, **how).points)
    return x.round(9).tolist(), y.round(9).tolist()


def said(text: str, **how: list[str]) -> str:
    return read_profile_file(text.encode(), **how).said


def refused(text: str | bytes, **how: list[str]) -> str:
    with pytest.raises(PointsError) as error:
        read_profile_file(text.encode() if isinstance(text, str) else text, **how)
    return str(error.value)


# Tables of text


@pytest.mark.parametrize(
    "text",
    [
        "x,y\n0,0\n1.5,0.25\n3,-1e-2\n",
        "x [m]; y [m]\n0;0\n1.5;0.25\n3;-0.01",
        "0;0\r\n1,5;0,25\r\n3;-0,01\r\n",
        "x,y\r0,0\r1.5,0.25\r3,-0.01\r",
        "\ufeff0\t0\n\n1.5\t.25\n  \n3\t-0.01\n",
        "0 0\n 1.5   0.25\n3 -0.01",
        "0 0\n1,5 0,25\n3 -0,01",
        "x [m]  z [m]\n0 0\n1.5 0.25\n3 -0.01",
        "0, 0\n1.5, 0.25\n3, -0.01",
        "sep=;\nx;y\n0;0\n1,5;0,25\n3;-0,01",
        '"Distance","Height"\n"0","0"\n"1,5","0,25"\n"3","-0,01"\n',
        '"Distance, along";"Height"\n0;0\n1.5;"0.25"\n3;-0.01\n',
        "# a remark\n! another\nx;y\n% and more\n0;0\n// of it\n1.5;0.25\n3;-0.01",
        "A made-up survey\nx,y\n0,0\n1.5,0.25\n3,-0.01",
        "z,x\n0,0\n0.25,1.5\n-0.01,3\n",
        "0;0;\n1.5;0.25;\n3;-0.01;\n",
        "x;y;;\n0;0;;\n1.5;0.25;;\n3;\u22120.01;;\n",
        "x;y\n0;0\n1.5;0.25\n3;\u20130.01\n",
        "x;y\n0;0\n1,5e0;2,5e-1\n3;-0,01\n",
    ],
)
def test_tables_of_text(text):
    assert read(text) == ([0.0, 1.5, 3.0], [0.0, 0.25, -0.01])


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding):
    assert read("Straße [m];Höhe [m]\n0;0\n1;0,1\n".encode(encoding)) == ([0.0, 1.0], [0.0, 0.1])


@pytest.mark.parametrize(
    ("heading", "x", "y"),
    [
        ("x [m],z [m]", 10.0, 0.2),
        ("x [m],height_mm", 10.0, 0.0002),
        ("x,height_mm", 10.0, 0.0002),
        ("Distance (ft),Elevation (in)", 3.048, 0.00508),
        ("dist_ft,elev_ft", 3.048, 0.06096),
        ("Chainage [km],Level [m]", 10000.0, 0.2),
        ("Station cm,z dm", 0.1, 0.02),
        ("Distance in feet,Height in inches", 3.048, 0.00508),
        ("Distance/ft.,Height/in", 3.048, 0.00508),
        ("x,z\nft,in", 3.048, 0.00508),
        ("x (left wheel),height (NAVD88) [cm]", 10.0, 0.002),
        ("x [Metres],z [MM]", 10.0, 0.0002),
        ("# x [m], z [mm]", 10.0, 0.0002),
    ],
)
def test_units_are_those_of_the_heading(heading, x, y):
    assert read(f"{heading}\n0,0\n10,0.2\n") == ([0.0, x], [0.0, pytest.approx(y)])


@pytest.mark.parametrize(
    ("heading", "words"),
    [
        ("x [m],height_mm [m]", "the heading 'height_mm [m]' names two units, m and mm"),
        ("x [m],height [mm]\nm,m", "the heading 'height [mm]' names two units"),
        ("x [m],height [furlong]", "the unit of 'height [furlong]' is unknown; give one of m, mm, cm, dm, km, ft, in"),
        ("x [m],height (yd)", "the unit of 'height (yd)' is unknown"),
        ("x [ft],height", "'height' names no unit, its neighbour is in ft; give road.units"),
        ("# heights in mm\nx,z", "a comment speaks of mm ('heights in mm') but no heading names a unit"),
    ],
)
def test_units_that_contradict_themselves_or_are_not_clear(heading, words):
    text = f"{heading}\n0,0\n10,0.2\n"
    assert words in refused(text)
    assert read(text, units=["m", "cm"], columns=["1", "2"])[1] == [0.0, 0.002]


@pytest.mark.parametrize("scale", [1000.0, 100.0, 39.37])
def test_heights_without_a_unit_that_look_like_no_metres(scale):
    rng = np.random.default_rng(0)
    heights = 0.05 * rng.standard_normal(50) * scale
    text = "\n".join(f"{0.5 * k} {height:.3f}" for k, height in enumerate(heights))
    assert "look like mm, cm or inches" in refused(text)
    assert read(text, units=["m", "mm"])
    assert read(text.replace("0.0", "x [m] z [mm]\n0.0", 1))


def test_the_roughest_road_in_metres_is_none_of_these():
    """Class H, and gravel that was scanned every millimetre."""
    from model.config.config import Config
    from model.road.road import build_road

    x = np.arange(0.0, 60.0, 0.05)
    rough = build_road(Config().replace({"road.type": "random", "road.roughness_class": "H"})).height(x)
    assert len(read("\n".join(f"{a:.2f} {b:.4f}" for a, b in zip(x, rough, strict=True)))[0]) == len(x)
    gravel = 0.001 * np.random.default_rng(0).standard_normal(3000)
    assert len(read("\n".join(f"{0.001 * k:.3f} {b:.4f}" for k, b in enumerate(gravel)))[0]) == 3000


def test_columns_by_heading_by_name_and_by_number():
    text = "easting,dist_m,elev_m,station\n7,0,0,9\n7,5,0.1,9\n"
    assert "There are 4: easting, dist_m, elev_m, station; give names or numbers by road.columns" in refused(text)
    for columns in (["dist_m", "elev_m"], ["2", "3"], ["DIST_M", "3"]):
        assert read(text, columns=columns) == ([0.0, 5.0], [0.0, 0.1])
    assert "there is no column 'z', or more than one; there are easting, dist_m" in refused(
        text, columns=["easting", "z"]
    )
    tracks = "x [m],left [mm],right [mm]\n0,0,0\n5,100,200\n"
    assert "which columns are x and height? There are 3: x [m], left [mm], right [mm]" in refused(tracks)
    assert read(tracks, columns=["right"]) == ([0.0, 5.0], [0.0, 0.2])
    assert read(tracks, columns=["x", "left"]) == ([0.0, 5.0], [0.0, 0.1])
    assert "There are 3: column 1, column 2, column 3" in refused("0,0,0\n1,0,0\n")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y\n0,0\n1,abc\n", "line 3: 'abc' is no number; give x and y in m (here y)"),
        ("0,0\n\n1,0,0\n", "line 3: 3 numbers; give 2, as in line 1"),
        ("0,0\n1\n", "line 2: 1 numbers; give 2"),
        ("0\n1\n", "line 1: one column; two are needed"),
        ("0,0\n1,0\n1,0\n", "line 3: x must grow from point to point, by 1 mm at least"),
        ("0,0\n1,0\n0.5,0\n", "line 3: x must grow"),
        ("0,0\n1,nan\n", "line 2: 'nan' is no number; give x and y in m (here column 2)"),
        ("nan,nan\n0,0\n1,0\n", "line 1: 'nan' is no number"),
        ("0,0\n1e9,0\n", "line 2: x must be from -1e6 to 1e6 m"),
        ("0,0\n1,20\n", "line 2: steeper than 85°"),
        ("x,y\n0,0\n", "1 point; give 2 to 200001"),
        ("", "0 points"),
        ("x,y\n0,0\n1_0,0\n", "line 3: '1_0' is no number"),
        ("x;y\n0;0\n1;\n", "line 3: the cell of 'y' is empty"),
        ("x;y\n0;0\n1 200;0\n", "line 3: '1 200' is no number"),
        ("x;y\n0;0\n1.200,5;0\n", "line 3: the comma in '1.200,5' may separate thousands"),
        ("x;y\n0;0\n1,200.5;0\n2;0,5\n", "line 3: the comma in '1,200.5' may separate thousands"),
        ("x;y\n0;0\n1,200,000;0\n", "line 3: the comma in '1,200,000' may separate thousands"),
        ("x;y\n1,200;0\n1,210;0\n", "line 2: the comma in '1,200' may separate thousands; write '1200'"),
        ("x,y,z\n0,0\n1,0\n", "line 2: 2 numbers below 3 headings"),
        ("0,0\n1,5,0,25\n", "line 2: 4 numbers; give 2"),
    ],
)
def test_faults_name_the_line(text, words):
    assert refused(text).startswith(words)


def test_files_that_are_too_large_or_no_text():
    assert "larger than 20000000 bytes" in refused(b"0" * 20_000_001)
    assert "is no text" in refused(b"\x00\x01\x02")
    assert "is no text" in refused(b"\xff\xfe0,0")
    assert "save the sheet as CSV" in refused(b"PK\x03\x04xl/workbook.xml")


def test_of_a_long_survey_the_first_points_are_taken():
    survey = "\n".join(f"{k} 0" for k in range(POINT_LIMIT + 9))
    assert len(read(survey)[0]) == POINT_LIMIT
    assert f"only the first {POINT_LIMIT} of {POINT_LIMIT + 9} points are taken" in said(survey)


def test_what_was_read_is_said():
    text = "Distance (ft),Elevation (ft)\n0,0\n100,0.1476\n196.85,-0.1017\n"
    assert said(text) == "3 points, 0 to 60 m, heights \u221231 to 44.99 mm; read as ft"
    assert said("0 0\n1 2\n") == "2 points, 0 to 1 m, heights 0 to 2 m; no unit named, read as m"
    assert said("x_m,z_mm,t\n0,0,1\n5,20,1\n", columns=["1", "2"]) == (
        "2 points, 0 to 5 m, heights 0 to 20 mm; x read as m, heights as mm; columns x_m and z_mm"
    )
    assert "its first point is a station, and is put 1 m ahead" in said("x [m],z [m]\n12345.6,0\n12350,0\n")


def test_units_given_against_the_heading_are_taken_with_a_word():
    text = "x [m],z [ft]\n0,0\n5,20\n"
    assert said(text, units=["m", "mm"]).endswith("heights as mm by road.units, though the file says heights in ft")
    assert said(text, units=["m", "ft"]).endswith("x read as m, heights as ft")
    assert said("x [m],z [yd]\n0,0\n5,20\n", units=["", "mm"]).endswith("x read as m, heights as mm")
    assert "by road.units, though the file says x in ft" in said(ERD + "0 0\n1 1\n2 2\n", units=["m"])


@settings(max_examples=300, deadline=None)
@given(
    st.one_of(
        st.text(alphabet='0123456789,;.\t\n -e"xz[m]#n\u2028\u2212', max_size=80),
        st.lists(
            st.sampled_from(
                ["x", "z", "[mm]", "1", "0,5", "-2.5", '"', ";", ",", "\t", "\n", "nan", "sep=", "#", "ft", " "]
            ),
            max_size=40,
        ).map("".join),
    ).map(str.encode)
    | st.binary(max_size=80)
)
@example(b"x\n,\n")
@example(b'";\n0;0\n1;0')
def test_any_content_gives_points_or_a_fault(content):
    try:
        x, y = points(read_profile_file(content).points)
    except PointsError:
        return
    assert len(x) == len(y) >= 2
    assert points_text(x, y) == points_text(*points(points_text(x, y)))


# What is likely, where a file alone is not clear


def likely(text: str) -> Reading | None:
    """What is proposed; it is one of the ways in which the file can be read."""
    source = open_profile_file(text.encode())
    found = source.likely()
    if found is not None:
        assert set(found.columns) <= set(source.columns)
        source.read(found.columns, found.units)
    return found


def rough(heading: str, scale: float) -> str:
    heights = scale * np.random.default_rng(0).standard_normal((50, heading.count(",") or 1))
    rows = (f"{0.5 * k:g}," + ",".join(f"{height:.3f}" for height in row) for k, row in enumerate(heights))
    return "\n".join([*([heading] if heading.strip(",") else []), *rows])


@pytest.mark.parametrize(
    ("heading", "scale", "columns", "units"),
    [
        (",", 50.0, ("1", "2"), ("m", "mm")),
        ("x,z", 50.0, ("x", "z"), ("m", "mm")),
        ("x [m],z [m]", 50.0, ("x [m]", "z [m]"), ("m", "mm")),
        ("# heights in cm\nx,z", 5.0, ("x", "z"), ("m", "cm")),
        ("dist [ft],elev", 0.1, ("dist [ft]", "elev"), ("ft", "ft")),
        ("dist,elev [in]", 0.1, ("dist", "elev [in]"), ("ft", "in")),
        ("x [m],height_mm [m]", 50.0, ("x [m]", "height_mm [m]"), ("m", "mm")),
        ("x [m],left,right", 0.05, ("x [m]", "left"), ("m", "m")),
        (",,,", 0.05, ("1", "2"), ("m", "m")),
        ("station,z,z", 0.05, ("station", "2"), ("m", "m")),
        ("km,a [mm],b [mm]", 50.0, ("km", "a [mm]"), ("m", "mm")),
    ],
)
def test_what_is_likely_where_a_file_is_not_clear(heading, scale, columns, units):
    assert likely(rough(heading, scale)) == Reading(columns, units)


def test_distance_is_a_column_that_grows_and_height_rather_one_that_does_not():
    rows = "\n".join(f"{3 * k},{k},{height}" for k, height in enumerate((0, 1, 0, 2)))
    assert likely(f"easting,time,q\n{rows}") == Reading(("easting", "q"), ("m", "m"))
    assert likely("0,0\n0.1,5\n0.0,10\n0.1,15") == Reading(("2", "1"), ("m", "m"))


@pytest.mark.parametrize("text", ["x,y\n0,0\n1,high\n", "x,z\n8,0\n6,1\n0,0\n", "100,2\n101,5\n103,7\n104,9"])
def test_what_can_be_read_in_no_way_has_no_likely_one(text):
    assert likely(text) is None


@pytest.mark.parametrize(
    ("text", "doubt"),
    [
        ("x [m],height_mm\n0,0\n1,0\n", ""),
        ("Straße [m];Höhe [m]\n0;0\n1;0\n", "No heading says which columns are distance and height"),
        ("x,z [m]\n0,0\n1,0\n", "The heading of x names no unit"),
        ("x,z\n0,0\n1,0\n", "The heading of x and of z names no unit"),
        ("0 0\n1 0\n", "No heading says which columns are distance and height"),
    ],
)
def test_what_a_file_does_not_say(text, doubt):
    assert open_profile_file(text.encode()).doubt == doubt


def test_channels_are_chosen_too():
    source = open_profile_file((FIELD / "two_tracks.erd").read_bytes())
    assert source.labels == ("LElev.", "RElev.")
    assert source.doubt == "It has several channels: LElev., RElev."
    assert source.likely() == Reading(("LElev.",), ("m", "mm"))
    one = "ERDFILEV2.00\n 1, 3, -1, 1, 5, 0.5, -1,\nSHORTNAMElev.\nUNITSNAM{}\nXUNITS  m\nEND\n 0\n 30\n 0\n"
    assert open_profile_file(one.format("mm").encode()).doubt == ""
    unknown = open_profile_file(one.format("volts").encode())
    assert unknown.likely() == Reading(("Elev.",), ("m", "mm"))  # 30 m within half a metre would be too steep


# ERD and OpenCRG

ERD = """ERDFILEV2.00
 2, 3, -1, 1, 5, 0.5, -1,
TITLE   lane
SHORTNAMLElev.  RElev.
UNITSNAMmm      in
XLABEL  Distance
XUNITS  ft
END
"""


def test_erd():
    text = ERD + "0 0\n 10.0 1.0\n20 2\n"
    assert read(text) == ([0.0, 0.1524, 0.3048], [0.0, 0.01, 0.02])
    assert read(text, columns=["RElev."])[1] == [0.0, 0.0254, 0.0508]
    assert read(text, columns=["x", "2"], units=["", "mm"])[1] == [0.0, 0.001, 0.002]
    assert said(text).endswith(
        "ERD, channel LElev. of LElev., RElev. (road.columns chooses), x read as ft, heights as mm"
    )
    assert refused(text, columns=["middle"]) == "there is no channel 'middle'; there are LElev., RElev."


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (ERD + "0 0\n1\n2 2\n", "ERD, line 10: 1 numbers; give 2"),
        (ERD + "0 0\n1 x\n2 2\n", "ERD, line 10: 'x' is no number"),
        (ERD + "0 0\n1 1\n", "ERD: 2 samples, where line 2 says 3"),
        (ERD.replace(" 5, 0.5", " 1, 0.5"), "ERD with numbers that are no text"),
        (ERD.replace("END\n", ""), "ERD: the header has no line END"),
        (ERD.replace("0.5", "zero"), "ERD, line 2: 'zero' is no number"),
        (ERD.replace("XUNITS  ft", "XUNITS  yd") + "0 0\n1 1\n2 2\n", "the unit 'yd' is unknown"),
    ],
)
def test_faults_of_erd(text, words):
    assert refused(text).startswith(words)


HEIGHTS = 0.01 * np.arange(5)[:, None] * np.array([1.0, 2.0, 3.0])  # at v = −1, 0, 1 m


def crg(kind: str, more: str = "", sections: str | None = None) -> bytes:
    """A made-up road of 5 × 3 heights, every 0.5 m."""
    if sections is None:
        sections = "".join(f"D:long section at v = {v:6.3f},m\n" for v in (-1, 0, 1))
    header = (
        "$CT\n  a made-up road\n$\n$ROAD_CRG\nREFERENCE_LINE_INCREMENT = 0.5  ! m\nREFERENCE_LINE_END_U = 2.0\n"
        f"{more}$\n* a comment\n$KD_Definition\n#:{kind}\nU:reference line u,m,0,0.5\nD:reference line phi,rad\n"
        f"{sections}$\n" + 80 * "$" + "\n"
    )
    table = np.column_stack([np.zeros(5), HEIGHTS])
    if kind[2] == "B":
        body = table.astype({"K": ">f4"}.get(kind[0], ">f8") if kind[1] == "R" else ">f8").tobytes()
        body += b"\x00" * (-len(body) % 80)
    else:
        width = 10 if kind[1] == "R" else 20
        lines = [f"{'**unused**':>{width}}" + "".join(f"{z:{width}.7f}" for z in row[1:]) for row in table]
        body = "\n".join(lines).encode()
    return header.encode() + body


@pytest.mark.parametrize("kind", ["LRFI", "LDFI", "KRBI", "KDBI"])
def test_open_crg(kind):
    assert read(crg(kind)) == ([0.0, 0.5, 1.0, 1.5, 2.0], pytest.approx([0.0, 0.02, 0.04, 0.06, 0.08]))
    assert read(crg(kind), columns=["x", "v=-1"])[1] == pytest.approx([0.0, 0.01, 0.02, 0.03, 0.04])
    assert read(crg(kind), columns=["v = 0.5"])[1] == pytest.approx([0.0, 0.025, 0.05, 0.075, 0.1])
    assert read_profile_file(crg(kind)).said.endswith("OpenCRG, v = 0 m, read as m")
    assert "v = 2 m lies off the road, which reaches from -1 to 1 m" in refused(crg(kind), columns=["v=2"])
    bare = crg(kind).partition(80 * b"$" + b"\n")
    assert refused(bare[0] + bare[1]).startswith("OpenCRG: 0 points below the header; give 2 to")


def test_open_crg_with_a_slope_and_numbered_sections():
    sections = "".join(f"D:long section {k},m\n" for k in (1, 2, 3))
    grid = "LONG_SECTION_V_RIGHT = -1.0\nLONG_SECTION_V_INCREMENT = 1.0\nREFERENCE_LINE_START_S = 0.1\n"
    assert read(crg("KRBI", grid, sections))[1] == pytest.approx([0.0, 0.07, 0.14, 0.21, 0.28])
    assert read(crg("KRBI", grid, sections), columns=["v=-1"])[1] == pytest.approx([0.0, 0.06, 0.12, 0.18, 0.24])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (crg("LRFI").replace(80 * b"$", b""), "OpenCRG: the header has no end"),
        (
            crg("LRFI").replace(b"#:LRFI", b"#:XYZW"),
            "OpenCRG with data of type 'XYZW'; LRFI, LDFI, KRBI, KDBI are read",
        ),
        (crg("LRFI").replace(b"0.0200000", b"0.02x0000"), "OpenCRG, record 2: '0.02x0000' is no number"),
        (
            crg("LRFI").replace(b" 0.0200000", b"**********"),
            "OpenCRG, v = 0 m: sample 2 is missing; choose another line by road.columns",
        ),
        (crg("LRFI", sections=""), "OpenCRG: the header defines no long sections"),
        (crg("LRFI", "$\n$ROAD_CRG_FILE\nother.crg\n"), "OpenCRG: the header names another file"),
    ],
)
def test_faults_of_open_crg(content, words):
    assert refused(content).startswith(words)


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([crg("LRFI"), crg("KRBI"), (ERD + "0 0\n1 1\n2 2\n").encode()]), st.data())
def test_headers_with_errors_give_points_or_a_fault(content, data):
    start = data.draw(st.integers(0, len(content)))
    end = data.draw(st.integers(start, min(start + 20, len(content))))
    with_error = content[:start] + data.draw(st.binary(max_size=5)) + content[end:]
    with suppress(PointsError):
        read_profile_file(with_error)


# Files from the field


@pytest.mark.parametrize(
    ("name", "first", "last", "count"),
    [
        ("metres_ok.csv", (0.0, 0.0), (120.0, 0.0), 481),
        ("height_mm.csv", (0.0, 0.0), (120.0, 0.0), 31),
        ("elevation_inch.csv", (0.0, 0.0), (119.99976, 0.0), 31),
        ("station_12345.csv", (12345.6, 0.0), (12465.6, 0.0), 481),
        ("station_125000.csv", (125000.0, 0.0), (125008.0, 0.1), 4),
        ("long_survey_63km.csv", (0.0, 75.0), (62950.0, 75.0), 1260),
        ("unicode_minus_first.csv", (-0.5, 0.2), (8.0, 0.1), 5),
        ("four_columns.csv", (0.0, 0.0), (8.0, 0.1), 4),
        ("comments.csv", (0.0, 0.0), (8.0, 0.1), 4),
        ("units_line.csv", (0.0, 0.0), (8.0, 0.1), 4),
        ("two_tracks.erd", (0.0, 0.0), (4.0, 0.002), 5),
    ],
)
def test_files_that_are_read(name, first, last, count):
    x, y = read((FIELD / name).read_bytes())
    assert len(x) == count
    assert (x[0], y[0]) == first
    assert x[-1] == pytest.approx(last[0])
    assert name == "long_survey_63km.csv" or y[-1] == pytest.approx(last[1])


def test_heights_in_mm_and_in_inches_are_the_same_road():
    (_, in_mm), (_, in_inches) = (read((FIELD / name).read_bytes()) for name in ("height_mm.csv", "elevation_inch.csv"))
    assert max(in_mm) == pytest.approx(0.0126, abs=1e-9)
    np.testing.assert_allclose(in_mm, in_inches, atol=2e-5)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("thousands_tab.tsv", "line 2: the comma in '1,200' may separate thousands; write '1200'"),
        ("dropouts_two_tracks.csv", "line 2: the cell of 'left m' is empty"),
        ("nan_first_row.csv", "line 1: 'NaN' is no number"),
        ("heights_only_decimal_comma.txt", "line 1: '100,2' looks like one column with a decimal comma"),
        ("reversed.csv", "x falls all along, as it must grow from point to point: turn the order of the lines round"),
    ],
)
def test_files_that_are_refused(name, words):
    assert refused((FIELD / name).read_bytes()).startswith(words)


def test_unknown_headings_are_told():
    """A column of time is not taken for a distance without a word."""
    assert read_profile_file(b"time,foo\n0,0\n5,0.1\n").said.endswith("columns time and foo")
    assert "columns" not in read_profile_file(b"x,height\n0,0\n5,0.1\n").said


def test_a_unit_that_is_not_known_is_told_with_its_key(tmp_path):
    (tmp_path / "road.csv").write_text("x,y\n0,0\n5,0.1\n")
    with pytest.raises(ConfigError, match=r"road\.units: .*'yd'.* is not allowed; give units"):
        read_profile(tmp_path / "road.csv", units={"x": "yd", "y": "m"})
