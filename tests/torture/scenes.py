"""Random scenes over everything that a scene can say, as strategies of Hypothesis: it draws them, and makes smaller those that break.

The keys, their ranges and defaults are read from `wisp info --keys`, so a new key is tortured without another line here. A span says where a
value is sensible if its default does not.
"""
import re

from hypothesis import strategies as st

# Keys of the same name mean the same in all blocks. None: the generator sets the key, or it must not be drawn.
SPANS = {
    **dict.fromkeys("""dt dt_factors steps workers gravity show max_points eye_angle min_spacing max_spacing scale translate position shape time step
        cursor pivot pin_pivot eye vertices strain_limit coarse_substeps coarse_passes tile_size max_iterations gas_ratio inflation_rate
        outlet_nearest outlet_radius outlet_open allow_open gust gust_per_triangle enabled within resample mass_ratio weld_distance velocity_of
        longest_step origin""".split()),
    "substeps": (2, 20), "iterations": (1, 4), "strain_gain": (0, 1),
    # meshes and grooms: a few hundred vertices, centimetres apart
    "columns": (2, 14), "rows": (2, 14), "spacing": (0.01, 0.07), "width": (0.1, 0.7), "depth": (0.1, 0.7), "level": (0, 2), "segments": (3, 14),
    "rings": (3, 10), "length_segments": (1, 8), "radius": (0.03, 0.3), "tube_radius": (0.01, 0.02), "length": (0.03, 0.5), "half_length": (0, 0.5),
    "half_extent": (0.02, 0.5), "strands": (1, 12), "dimension": (3, 3), "scalp_radius": (0.03, 0.1), "wave_amplitude": (1e-3, 0.02),
    "wave_length": (0.02, 0.2), "samples": (1, 8), "count": (1, 4),
    # what things are made of
    "area_density": (0.01, 5), "vertex_mass": (1e-5, 1e-2), "line_density": (1e-6, 1e-3), "warp_compliance": (1e-8, 1e-2),
    "weft_compliance": (1e-8, 1e-2), "shear_compliance": (1e-8, 1e-2), "stretch_compliance": (1e-8, 1e-2), "bend_compliance": (1e-4, 10),
    "edge_stiffness": (50, 2e4), "bend_link_stiffness": (0.2, 2e3), "compression_stiffness": (1, 1e4), "link_damping": (1e-4, 1),
    "internal_damping": (0.05, 20), "damping": (0.05, 20), "bend_damping": (1e-4, 0.1), "warp": (-1, 1), "tether_slack": (1, 1.5), "teleport": (1, 20),
    # solvers
    "newton_iterations": (1, 4), "max_newton_iterations": (1, 16), "tolerance": (1e-6, 1e-2), "stretch_passes": (2, 8),
    "stretch_tolerance": (1e-4, 0.1), "max_neighbours": (8, 256), "margin": (0.1, 10),
    # air, gas and weather
    "wind": (-8, 8), "air_density": (0.1, 5), "drag_coefficient": (0.05, 2), "lift_coefficient": (0.05, 2), "min_gas_ratio": (0.2, 1),
    "atmospheric_pressure": (1e3, 5e5), "temperature": (200, 400), "gas_molar_mass": (2e-3, 0.05), "air_molar_mass": (0.01, 0.05),
    "temperature_celsius": (-30, 30), "freezing_celsius": (-5, 5), "velocity": (-3, 3), "angular_velocity": (-6, 6),
    # contact, seams, ghosts
    "thickness": (1e-3, 0.02), "friction": (0, 1.5), "friction_scale": (0, 2), "max_push_out_speed": (0.05, 2), "repulsion": (0, 20),
    "distance": (0, 0.05), "compliance": (1e-6, 10), "strength": (0.01, 100), "target_count": (1, 3), "tip_gain": (0, 2), "centre_gain": (0, 2),
    "spread": (0.2, 3),
}
WORDS = 60  # percent: words choose the code that runs, numbers only what it computes


def read_keys(text):
    """Return the keys of each block, from what `wisp info --keys` prints."""
    blocks, field = {}, None
    for line in text.splitlines():
        head = re.fullmatch(r"### `?([^`]*)`?", line)
        row = re.match(r"- `(\w+)`(?: of ((?:`\w+`(?:, )?)+))? \((.*)\): ", line)
        choice = re.match(r"  - `(\w+)`: ", line)
        if head:
            keys = blocks.setdefault("" if head[1] == "The scene" else head[1], [])
        elif row:
            kind = row[3]
            span = re.search(r"(-?[\d.e+-]+) \.\. (-?[\d.e+-]+)", kind)
            initial = re.search(r"default `?(-?[\d.e+-]+|true|false|\w+)`?$", kind)
            field = {
                "key": row[1], "shapes": re.findall(r"`(\w+)`", row[2] or ""), "words": [],
                "kind": "vector" if kind.startswith("[x, y, z]") else "whole" if kind.startswith("whole") else "number" if kind.startswith("number")
                else "switch" if kind.startswith("true or false") else "choice" if kind.startswith("choice") else "",
                "range": (float(span[1]), float(span[2])) if span else None,
                "initial": float(initial[1]) if initial and re.fullmatch(r"-?[\d.]+(e-?\d+)?", initial[1]) else None,
                "unit": (re.search(r", ([^,\d][^,]*), -?[\d.]", kind) or [None, ""])[1],
            }
            keys.append(field)
        elif choice and field:
            field["words"].append(choice[1])
    return blocks


class Builder:
    """A scene in the making."""

    def __init__(self, draw, blocks):
        self.draw, self.blocks = draw, blocks
        self.scene = {}
        self.surfaces, self.strands, self.colliders, self.events, self.hair_events = [], [], [], [], []

    # ---- numbers: the simplest one of each is the first ----

    def whole(self, lower, upper):
        return self.draw(st.integers(int(lower), int(upper)))

    def chance(self, percent):
        return self.draw(st.integers(0, 99)) >= 100 - percent

    def one_of(self, words):
        return self.draw(st.sampled_from(words))

    def linear(self, lower, upper):
        return float(f"{lower + (upper - lower) * self.whole(0, 40) / 40:.3g}")

    def log(self, lower, upper):
        grid = [float(f"{digit}e{power}") for power in range(-15, 15) for digit in (1, 2, 3, 5, 7)]
        return self.one_of([value for value in grid if lower * (1 - 1e-6) <= value <= upper * (1 + 1e-6)] or [lower])

    def vector(self, lower, upper):
        return [self.linear(a, b) for a, b in zip(lower, upper)]

    # ---- keys by their tables ----

    def number(self, field):
        initial = field["initial"] if field["initial"] is not None else 1.0
        least, most = field["range"] or (-10, 10)
        span = SPANS.get(field["key"])
        lower, upper = span or (initial / 100, initial * 100)
        if not span and (initial <= 0 or most - least <= 10):
            lower, upper = least, min(most, least + 10)
        lower, upper = max(lower, least), min(upper, most)
        return self.log(lower, upper) if lower > 0 and upper / lower > 20 else self.linear(lower, upper)

    def value(self, field):
        """Return a value for a key, or None if the generator sets it itself."""
        kind, initial = field["kind"], field["initial"] or 0
        if kind == "" or (field["key"] in SPANS and SPANS[field["key"]] is None):
            return None
        if kind == "whole":
            least, most = field["range"]
            lower, upper = SPANS.get(field["key"]) or ((1, 999) if field["key"] == "seed" else (initial // 2, 2 * initial + 1))
            return self.whole(max(lower, least), max(max(lower, least), min(upper, most)))
        if kind == "switch":
            return self.one_of([False, True])
        if kind == "choice":
            return self.one_of(field["words"])
        return [self.number({**field, "initial": 0}) for _ in range(3)] if kind == "vector" else self.number(field)

    def fill(self, path, percent, block, shape=None):
        """Give a block random values for some of its keys, those without one."""
        for field in self.blocks[path]:
            chance = WORDS if field["kind"] == "choice" and 0 < percent < WORDS else percent
            if field["key"] not in block and (not field["shapes"] or shape in field["shapes"]) and self.chance(chance):
                value = self.value(field)
                if value is not None:
                    block[field["key"]] = value
        return block

    # ---- pieces ----

    def keyframes(self, position, rotation, centre):
        frames, time = [], 0.0
        for _ in range(self.whole(1, 4)):
            # cloth that collapses in a jump touches itself everywhere, and a step of it costs a thousand times as much
            time += 0.001 if self.chance(2 if self.has_contact else 15) else 0.05 * self.whole(1, 8)
            frame = {"time": float(f"{time:.5g}"), position: self.vector([c - 0.3 for c in centre], [c + 0.3 for c in centre])}
            if self.chance(40):
                frame[rotation] = {"degrees": self.vector([-180] * 3, [180] * 3)}
            frames.append(frame)
        return frames

    def mesh(self, is_closed):
        closed = ["icosphere", "uv_sphere", "torus", "capsule", "pear"]
        shape = self.one_of(closed if is_closed or self.chance(15)
                            else ["plane", "plane", "alternating_plane", "irregular_plane", "delaunay", "garment", "tube"])
        generate = {"shape": shape}
        if shape == "torus":
            generate.update(radius=self.linear(0.1, 0.2), tube_radius=self.linear(0.03, 0.08))
        if shape in ("delaunay", "garment"):
            generate["vertices"] = self.whole(64, 160)
        return self.fill("surfaces[].generate", 100, generate, shape)

    # ---- surfaces ----

    def pins(self, entry, place):
        columns = entry.get("generate", {}).get("columns")
        if columns and self.chance(50):
            entry["pins"] = [0, columns - 1]
        else:
            entry["pin_nearest"] = [self.vector([p - 0.3 for p in place], [p + 0.3 for p in place]) for _ in range(self.whole(1, 3))]
        if self.chance(45):
            entry["pin_keyframes"] = self.keyframes("translate", "rotate", [0, 0, 0])

    def cloth(self, entry, is_pinned, is_instance):
        cloth = entry["cloth"] = self.fill("surfaces[].cloth", 30, {})
        if not is_pinned or is_instance:
            cloth.pop("tethers", None)
        generate = entry.get("generate", {})
        # other meshes are too small for a coarse sheet
        if self.chance(20) and "plane" in generate.get("shape", "") and cloth.get("solver") != "pbd":
            generate.update(columns=27, rows=27)
            cloth.update(coarse_substeps=self.whole(1, 3), coarse_passes=self.whole(1, 20))

    def balloon(self, entry):
        balloon = entry["balloon"] = {**self.fill("surfaces[].balloon", 25, {}), "gas_ratio": self.linear(1, 1.6)}
        if self.chance(25):
            balloon["gas_ratio_keyframes"] = [[0.4 * i, self.linear(1, 1.8)] for i in range(3)]
        if self.chance(10):
            balloon["inflation_rate"] = self.log(1e-5, 1e-2)
        if self.chance(25):
            balloon.update(outlet_nearest=self.vector([-0.2, 0, -0.2], [0.2, 0.6, 0.2]), outlet_open=self.chance(50))

    def implicit(self, entry, source):
        implicit = entry["implicit"] = self.fill("surfaces[].implicit", 30, {})
        # links of quads need a regular plane and stiffnesses of links
        if source.get("generate", {}).get("shape") != "plane" or implicit.get("stiffness_model") != "link":
            implicit.pop("links", None)

    def surroundings(self, entry):
        if self.chance(65):
            entry["damping"] = self.log(0.5, 10)
        if self.chance(85):
            entry["collision"] = self.fill("surfaces[].collision", 25, {})
            if "implicit" in entry:
                entry["collision"].pop("features", None)
        if self.has_contact and self.chance(80):
            entry["contact"] = {**self.fill("surfaces[].contact", 25, {}), "thickness": self.log(1e-3, 5e-3)}
        if "implicit" not in entry and self.chance(15):
            entry["strain_limit"] = [self.linear(0, 0.95), self.linear(1.02, 1.5)]
        for block, percent, keys in (("sleep", 20, 30), ("boundary", 8, 20)):
            if self.chance(percent):
                entry[block] = self.fill(f"surfaces[].{block}", keys, {})

    def layer(self):
        """Add a cloth of a stack: it lies flat, a few centimetres above the one below, and weighs what it likes."""
        number, shape = len(self.surfaces), self.one_of(["plane", "alternating_plane"])
        y = 0.03 + 0.05 * number
        entry = {
            "name": f"surface{number}", "generate": self.fill("surfaces[].generate", 100, {"shape": shape}, shape),
            "transform": {"rotate": {"degrees": self.vector([0, -90, 0], [0, 90, 0])}, "translate": self.vector([-0.05, y, -0.05], [0.05, y, 0.05])},
            "area_density": self.log(0.02, 20), "damping": self.log(0.5, 10), "cloth": self.fill("surfaces[].cloth", 15, {}),
            "collision": self.fill("surfaces[].collision", 15, {}),
            "contact": {**self.fill("surfaces[].contact", 15, {}), "thickness": self.log(2e-3, 0.02)},
        }
        entry["cloth"].pop("tethers", None)
        entry["cloth"].pop("wind", None)
        self.surfaces.append(entry)

    def surface(self):
        number, kind = len(self.surfaces), self.one_of(["cloth"] * 9 + ["balloon"] * 6 + ["implicit"] * 4 + [""])
        first = self.surfaces[0] if number else {}
        is_instance = "generate" in first and "balloon" in first and self.chance(30)
        entry = {"name": f"surface{number}"}
        self.surfaces.append(entry)
        entry.update({"instance_of": first["name"]} if is_instance else {"generate": self.mesh(kind == "balloon")})
        transform, y = {}, 0.3 + 0.35 * number
        if self.chance(50):
            transform["rotate"] = {"degrees": self.vector([-90] * 3, [90] * 3)}
        place = transform["translate"] = self.vector([-0.1, y, -0.1], [0.1, y + 0.1, 0.1])
        entry["transform"] = transform
        is_pinned = self.chance(20 if kind == "balloon" else 55)
        if is_pinned:
            self.pins(entry, place)
        self.fill("surfaces[]", 20, entry)
        if is_instance:
            entry.pop("solve_order", None)
        if kind == "cloth":
            self.cloth(entry, is_pinned, is_instance)
        elif kind == "balloon":
            self.balloon(entry)
        elif kind == "implicit":
            self.implicit(entry, first if is_instance else entry)
        self.surroundings(entry)

    # ---- strands ----

    def groom(self, entry, is_frozen):
        shape = self.one_of(["straight", "wavy", "curly"])
        generate = {"shape": shape, "strands": self.whole(1, 12), "vertices": self.whole(4 if is_frozen else 2, 24)}
        entry["generate"] = self.fill("strands[].generate", 100, generate)
        entry["transform"] = {"translate": self.vector([-0.1, 0.4, -0.1], [0.1, 0.8, 0.1])}

    @staticmethod
    def keep_rules(entry, dynamics):
        """Take out what the reader refuses together."""
        is_rod, edgewise, flat = dynamics.get("bending", "rod") == "rod", dynamics.get("edgewise_rigidity", 0), dynamics.get("bend_rigidity", 8e-9)
        if dynamics.get("integrator") == "bdf2":
            dynamics.pop("stretch", None)
        if not is_rod or not flat <= edgewise <= 1e5 * flat:
            for key in ("edgewise_rigidity", "natural_twist", "flat_normal"):
                dynamics.pop(key, None)
        for key in ("closed", "closing_twist"):
            dynamics.pop(key, None)
        if (is_rod and dynamics.get("rest", "sag_free") == "sag_free") or "tips" in entry:
            dynamics.pop("free_roots", None)

    def dynamics(self, entry):
        dynamics = entry["dynamics"] = self.fill("strands[].dynamics", 30, {})
        self.keep_rules(entry, dynamics)
        if self.chance(70):
            dynamics["damping"] = self.log(0.5, 10)
        vertices = entry["generate"]["strands"] * entry["generate"]["vertices"]
        if vertices < 60 and self.chance(10):
            dynamics.pop("vertex_mass", None)
            dynamics["vertex_masses"] = [self.log(1e-6, 1e-4) for _ in range(vertices)]
        if self.surfaces and self.chance(30) and not dynamics.get("free_roots"):
            entry["on_surface"] = self.surfaces[0]["name"]
        elif self.chance(60):
            entry["head"] = {"keyframes": self.keyframes("position", "rotation", entry["transform"]["translate"])}
        for block, percent in (("grid", 25), ("collision", 55), ("contact", 60), ("sleep", 20)):
            if (block != "contact" or self.has_contact) and self.chance(percent):
                entry[block] = self.fill(f"strands[].{block}", 30, {})

    def frozen_hair(self, entry):
        frozen = entry["frozen_hair"] = self.fill("strands[].frozen_hair", 30, {})
        for stage in ("freeze", "align", "clump"):
            if self.chance(60):
                frozen[stage] = self.fill(f"strands[].frozen_hair.{stage}", 30, {})
        # a stroke has its cursors from hair events, and they need strands that align
        if frozen.get("base") == "stroke":
            frozen.get("align", {}).pop("cursor", None)
            if "align" not in frozen:
                frozen.pop("base")
        if self.chance(40):
            entry["environment"] = self.fill("strands[].environment", 40, {})

    def hair(self):
        entry, is_frozen = {"name": f"hair{len(self.strands)}"}, self.chance(15)
        self.strands.append(entry)
        self.groom(entry, is_frozen)
        (self.frozen_hair if is_frozen else self.dynamics)(entry)
        if self.chance(15):
            entry["appearance"] = self.fill("strands[].appearance", 40, {})
        if not is_frozen and self.chance(35):
            scatter = {"around": entry["name"], "count": self.whole(1, 4), "radius": self.linear(0, 0.02)}
            ghosts = {"name": f"ghosts{len(self.strands)}", "scatter": scatter, "ghosts": self.fill("strands[].ghosts", 30, {})}
            self.strands.append(ghosts)
            if self.chance(25):
                ghosts["collision"] = self.fill("strands[].collision", 30, {})
            if self.chance(20):
                self.frozen_hair(ghosts)
        if self.chance(15):
            curves = {"of": entry["name"]}
            self.strands.append({"name": f"curves{len(self.strands)}", "curves": self.fill("strands[].curves", 50, curves)})

    # ---- colliders, seams, events ----

    def collider(self):
        is_ground = not self.colliders and (self.is_stack or self.chance(85))
        shape = "plane" if is_ground else self.one_of(["sphere", "capsule", "box", "mesh", "tapered_capsule", "convex", "height_field"])
        entry, centre = {"name": f"body{len(self.colliders)}", "shape": shape}, [0, 0, 0]
        self.colliders.append(entry)
        if shape == "mesh":
            is_open = self.chance(30)
            entry["generate"] = self.mesh(not is_open)
            entry.update({"double_sided": True} if is_open else {})
        if shape == "convex":  # of few points: a hull has at most 1024
            entry["generate"] = {"shape": "icosphere", "level": self.whole(0, 2), "radius": self.log(0.02, 0.2)}
        if not is_ground:
            centre = entry["position"] = self.vector([-0.2, -0.1, -0.2], [0.2, 0.2, 0.2])
        if shape == "height_field":
            columns = self.whole(2, 8)
            entry["heights"] = [[self.linear(-0.3, 0.1) for _ in range(columns)] for _ in range(self.whole(2, 8))]
            entry["spacing"] = self.log(0.05, 0.5)
        entry["friction"] = [self.linear(0.6, 1.2), self.linear(0, 0.6)] if self.chance(30) else self.linear(0, 1.2)
        # the defaults are a metre: everything else would start inside
        for key, shapes in (("radius", "sphere capsule"), ("top_radius", "tapered_capsule"), ("bottom_radius", "tapered_capsule")):
            if shape in shapes.split():
                entry[key] = self.log(0.02, 0.2)
        if shape in ("capsule", "tapered_capsule"):
            entry["half_length"] = self.linear(0, 0.4)
        if shape == "box":
            entry["half_extent"] = self.vector([0.02] * 3, [0.3, 0.15, 0.3])
        self.fill("colliders[]", 35, entry, shape)
        if self.chance(10 if is_ground else 45):
            entry["keyframes"] = self.keyframes("position", "rotation", centre)

    def seam(self):
        names = [self.one_of(self.surfaces)["name"] for _ in range(2)]
        seam = {"name": "seam0", "surfaces": names, "pairs": [[i, (i + 1) % 3] for i in range(self.whole(0, 1), 3)]}
        return self.fill("seams[]", 40, seam)  # the first vertices are there in every mesh

    def change_surface(self, event, surface):
        event["surface"] = surface["name"]
        cloth, balloon = surface.get("cloth", {}), surface.get("balloon", {})
        is_pinned = any(key in surface for key in ("pins", "pin_nearest", "pin_box"))
        is_released = any("release" in other and other["surface"] == surface["name"] for other in self.events)
        if (cloth.get("drag_coefficient", 0) > 0 or cloth.get("lift_coefficient", 0) > 0) and self.chance(50):
            event["wind"] = self.vector([-8, -2, -8], [8, 2, 8])
        elif is_pinned and not is_released and self.chance(30):
            event["release"] = True
        elif "outlet_nearest" in balloon and self.chance(40):
            event["outlet_open"] = self.chance(70)
        elif balloon and "gas_ratio_keyframes" not in balloon and self.chance(60):
            event["gas_ratio"] = self.linear(1, 1.6)
        elif self.chance(25):
            event["gust"] = self.vector([-1] * 3, [1] * 3)
            event.update({"gust_per_triangle": True} if self.chance(30) else {})
        else:
            event["velocity"] = self.vector([-3] * 3, [3] * 3)

    def event(self, number):
        entry, event = self.one_of(self.surfaces + self.strands), {"step": number * self.scene["steps"] // 10}
        if entry in self.surfaces:
            self.events.append(event)
            self.change_surface(event, entry)
        elif "frozen_hair" in entry:
            self.hair_events.append({**event, "strands": entry["name"], "cursor": self.vector([-0.3, 0, -0.3], [0.3, 0.8, 0.3])})
        elif entry.get("dynamics", {}).get("drag_coefficient", 0) > 0:
            self.events.append({**event, "strands": entry["name"], "wind": self.vector([-8, -2, -8], [8, 2, 8])})

    # ---- scenes ----

    def world(self):
        dt = self.one_of([0.0166667, 0.0166667, 0.0166667, 0.004, 0.008, 0.033, 0.05])
        most = 150 if self.has_contact else 240  # contact is what costs most
        self.scene.update(wisp=1, dt=dt, steps=min(int(self.whole(2, 5) / dt), most), substeps=self.one_of([10, 10, 10, 2, 4, 5, 8, 16, 20]))
        if self.chance(25):
            self.scene["dt_factors"] = [self.log(0.1, 3) for _ in range(self.whole(2, 7))]
        if self.chance(25):
            self.scene["iterations"] = self.whole(1, 4)
        if self.chance(20):
            self.scene["gravity"] = self.vector([-4, -20, -4], [4, 0, 4])
        if self.has_contact and self.chance(40):
            self.scene["contact"] = self.fill("contact", 30, {})

    def make(self):
        kind = self.one_of(["plain"] * 8 + ["mixed"] * 4 + ["stack"])  # hair, a surface and a body meet in a third
        self.is_stack = kind == "stack"
        self.has_contact = kind != "plain" or self.chance(20)
        self.world()
        surfaces = self.whole(*{"plain": (0, 3), "mixed": (1, 2), "stack": (2, 3)}[kind])
        for _ in range(surfaces):
            (self.layer if self.is_stack else self.surface)()
        if kind == "mixed" or surfaces == 0 or self.chance(30):
            self.hair()
        for _ in range(1 if self.is_stack else self.whole(1 if kind == "mixed" else 0, 3)):
            self.collider()
        for number in range(self.whole(0, 3), 0, -1):
            self.event(number)
        seams = [self.seam()] if surfaces and self.chance(15) else []
        lists = {"surfaces": self.surfaces, "strands": self.strands, "colliders": self.colliders, "seams": seams, "events": self.events,
                 "hair_events": self.hair_events}
        self.scene.update({key: entries for key, entries in lists.items() if entries})
        # the same materials at another size are stiff or soft, and fall through their own size at once or never
        return self.resized(self.scene, self.one_of([0.01, 0.02, 0.1, 5])) if self.chance(18) else self.scene

    def resized(self, scene, factor):
        powers, fields = {"m": 1, "m^2": 2, "m^3/s": 3}, {}
        for field in (field for block in self.blocks.values() for field in block):
            same = fields.setdefault(field["key"], dict(field))
            if same["range"] and field["range"]:  # blocks have keys of one name and other ranges
                same["range"] = (max(same["range"][0], field["range"][0]), min(same["range"][1], field["range"][1]))

        def scaled(value, power, span):
            if isinstance(value, list):
                return [scaled(item, power, span) for item in value]
            if isinstance(value, dict):
                known = {key: fields.get(key, {}) for key in value}
                return {key: scaled(item, 1 if key in ("pin_nearest", "heights") else powers.get(known[key].get("unit"), 0), known[key].get("range"))
                        for key, item in value.items()}
            if not power or isinstance(value, (bool, str)):
                return value
            least, most = span or (-1e6, 1e6)
            return float(f"{min(max(value * factor**power, least), most):.3g}")

        return scaled(scene, 0, None)


def scenes(blocks):
    """Return the strategy of scenes."""
    return st.composite(lambda draw: Builder(draw, blocks).make())()
