"""Recordings for ParaView, read by VTK itself (Debian's python3-vtk9): ./dev readers runs it.

usage: test_vtk.py PROGRAM
"""
import array
import math
import os
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import vtk

import wisp_recording

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
STEPS = 12
PROGRAM = None


def record(scene, path, *options):
    subprocess.run([PROGRAM, "run", os.path.join(ROOT, "data/scenes", scene + ".yaml"), "--steps", str(STEPS), "--record", path,
                    *options], check=True, stdout=subprocess.DEVNULL)


def read_vtp(path):
    """What VTK reads; its complaints are errors."""
    complaints = []
    reader = vtk.vtkXMLPolyDataReader()
    for event in ("ErrorEvent", "WarningEvent"):
        reader.AddObserver(event, lambda *_: complaints.append(path))
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    reader.Update()
    assert not complaints
    return reader.GetOutput()


def floats(vtk_array):
    return array.array("f", memoryview(vtk_array).tobytes())


def cells(cell_array):
    """The vertices of each cell."""
    ids, result = vtk.vtkIdList(), []
    cell_array.InitTraversal()
    while cell_array.GetNextCell(ids):
        result.append(tuple(ids.GetId(i) for i in range(ids.GetNumberOfIds())))
    return result


class Recording:
    """The .vtp files of a run by body and frame, and the same run as .wisp."""

    def __init__(self, folder, scene, *options):
        record(scene, os.path.join(folder, "r.wisp"))
        self.bodies, self.times = wisp_recording.read(os.path.join(folder, "r.wisp"))
        record(scene, os.path.join(folder, "r.pvd"), *options)
        self.entries = [entry.attrib for entry in xml.parse(os.path.join(folder, "r.pvd")).iter("DataSet")]
        files = {entry["file"] for entry in self.entries}
        self.data = {file: read_vtp(os.path.join(folder, file)) for file in files}

    def of(self, body, frame):
        return self.data[[entry for entry in self.entries if entry["name"] == body][frame]["file"]]


class VtkTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folders, cls.recordings = [], {}
        for scene in ("hair_on_balloon", "flag", "moving_floor_cloth"):
            cls.folders.append(tempfile.TemporaryDirectory())
            cls.recordings[scene] = Recording(cls.folders[-1].name, scene, "--record-with", "strain,speed")

    @classmethod
    def tearDownClass(cls):
        for folder in cls.folders:
            folder.cleanup()

    def test_points_triangles_and_lines_are_those_of_the_recording(self):
        for recording in self.recordings.values():
            for body in recording.bodies:
                for frame in range(STEPS + 1):
                    data = recording.of(body.name, frame)
                    self.assertEqual(floats(data.GetPoints().GetData()), body.frames[frame])
                if body.is_strands:
                    lines = [tuple(range(a, b)) for a, b in zip(body.numbers, body.numbers[1:])]
                    self.assertEqual(cells(data.GetLines()), lines)
                else:
                    corners = iter(body.numbers)
                    self.assertEqual(cells(data.GetPolys()), list(zip(corners, corners, corners)))

    def test_the_list_has_the_times_of_the_frames(self):
        for recording in self.recordings.values():
            for body in recording.bodies:
                times = [float(entry["timestep"]) for entry in recording.entries if entry["name"] == body.name]
                self.assertEqual(times, recording.times)

    def test_a_body_that_stands_still_is_one_file_and_one_with_keyframes_is_not(self):
        for scene, body, files in (("flag", "mast", 1), ("moving_floor_cloth", "table", STEPS + 1)):
            entries = self.recordings[scene].entries
            self.assertEqual(len({entry["file"] for entry in entries if entry["name"] == body}), files)

    def test_arrays_have_the_roles_that_vtk_knows(self):
        balloon = self.recordings["hair_on_balloon"].of("balloon", STEPS).GetPointData()
        self.assertEqual(balloon.GetNormals().GetName(), "Normals")
        self.assertEqual(balloon.GetScalars().GetName(), "strain")
        self.assertIsNotNone(balloon.GetArray("speed"))
        curtain = self.recordings["hair_on_balloon"].of("curtain", STEPS).GetPointData()
        self.assertIsNone(curtain.GetNormals())
        self.assertEqual(curtain.GetArray("width").GetRange(), (struct_float(1e-3), struct_float(2e-3)))
        self.assertEqual(curtain.GetArray("RGB").GetNumberOfComponents(), 3)
        mast = self.recordings["flag"].of("mast", 0).GetPointData()
        self.assertEqual([mast.GetArray(i).GetName() for i in range(mast.GetNumberOfArrays())], ["Normals"])

    def test_speed_is_how_far_vertices_move_in_a_short_step(self):
        # The balloon drifts by 0.5 m/s, and nothing has touched it yet: the speed is that of the next displacement.
        recording = self.recordings["hair_on_balloon"]
        balloon = next(body for body in recording.bodies if body.name == "balloon")
        speed = floats(recording.of("balloon", STEPS).GetPointData().GetArray("speed"))
        a, b = balloon.frames[STEPS - 1], balloon.frames[STEPS]
        dt = recording.times[STEPS] - recording.times[STEPS - 1]
        for v in range(balloon.vertices):
            moved = math.dist(a[3 * v:3 * v + 3], b[3 * v:3 * v + 3]) / dt
            # the membrane trembles: a tenth of the drift
            self.assertAlmostEqual(speed[v], moved, delta=0.05)

    def test_strain_of_cloth_is_that_of_its_edges(self):
        # |l / l0 - 1| at most, over the edges at a vertex; the rest shape is that of the first frame.
        recording = self.recordings["flag"]
        flag = next(body for body in recording.bodies if body.name == "flag")
        rest, now = flag.frames[0], flag.frames[STEPS]
        expected = [0.0] * flag.vertices
        for t in range(0, len(flag.numbers), 3):
            for k in range(3):
                i, j = flag.numbers[t + k], flag.numbers[t + (k + 1) % 3]
                l0, l = (math.dist(x[3 * i:3 * i + 3], x[3 * j:3 * j + 3]) for x in (rest, now))
                for v in (i, j):
                    expected[v] = max(expected[v], abs(l / l0 - 1))
        strain = floats(recording.of("flag", STEPS).GetPointData().GetArray("strain"))
        for v in range(flag.vertices):
            # single precision of positions of about 1 m and edges of 15 mm
            self.assertAlmostEqual(strain[v], expected[v], delta=3e-5)

    def test_normals_are_unit_vectors_across_the_surface(self):
        recording = self.recordings["moving_floor_cloth"]
        body = next(body for body in recording.bodies if body.name == "table")
        data = recording.of("table", STEPS)
        normals = floats(data.GetPointData().GetNormals())
        self.assertTrue(all(abs(math.hypot(*normals[i:i + 3]) - 1) < 1e-6 for i in range(0, len(normals), 3)))
        centre = data.GetCenter()
        points = body.frames[STEPS]
        for v in range(body.vertices):
            self.assertGreater(sum(normals[3 * v + k] * (points[3 * v + k] - centre[k]) for k in range(3)), 0)


def struct_float(number):
    return array.array("f", [number])[0]


if __name__ == "__main__":
    PROGRAM = sys.argv.pop()
    unittest.main()
