"""Writes the files of this folder with Blender's own exporters.

    python make.py [FOLDER]

Needs the package `bpy` 4.5 (Blender as a Python module, on PyPI for Python 3.11); the tests do not. The same
version writes the same bytes again. `truth.json` holds what Blender says of each file: transforms, colours and
energies, in Blender's own frame (z up) and units (watts, watts per square metre for a sun).
"""

import json
import math
import sys
from pathlib import Path

import bpy
from mathutils import Euler, Matrix, Vector

HERE = Path(__file__).resolve().parent

# Base colours of the room's materials. A texture has none: the exporters write no factor beside it.
WHITE, RED, GREEN = (0.75, 0.75, 0.75), (0.6, 0.1, 0.1), (0.1, 0.5, 0.15)
GOLD, BLUE, CLAY = (0.9, 0.7, 0.3), (0.15, 0.25, 0.7), (0.7, 0.45, 0.3)
PANEL_RADIANCE = 6.0


# Materials


def principled(name, colour, metallic=0.0, roughness=0.5, specular=0.5, emission=0.0):
    """A material as people make it: the Principled BSDF with Blender's defaults for all but a few inputs."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"].inputs
    shader["Base Color"].default_value = (*colour, 1.0)
    shader["Metallic"].default_value = metallic
    shader["Roughness"].default_value = roughness
    shader["Specular IOR Level"].default_value = specular
    if emission > 0.0:
        shader["Emission Color"].default_value = (1.0, 0.9, 0.8, 1.0)
        shader["Emission Strength"].default_value = emission
    return material


def textured(name, image):
    """A material whose base colour is a texture, with Blender's defaults for all else."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def checker(folder):
    """An image of 8 by 8 pixels, saved as `checker.png`."""
    image = bpy.data.images.new("checker", 8, 8)
    tiles = [(0.8, 0.7, 0.6, 1.0) if (x + y) % 2 else (0.3, 0.2, 0.15, 1.0) for y in range(8) for x in range(8)]
    image.pixels = [component for tile in tiles for component in tile]
    image.filepath_raw, image.file_format = str(folder / "checker.png"), "PNG"
    image.save()
    return image


# Objects


def place(name, data, material=None, location=(0, 0, 0), rotation=(0, 0, 0), scale=(1, 1, 1)):
    """An object with these data at a place; rotation in degrees about x, y and z."""
    thing = bpy.data.objects.new(name, data)
    thing.location, thing.scale = location, scale
    thing.rotation_euler = Euler([math.radians(angle) for angle in rotation])
    if material is not None and not data.materials:
        data.materials.append(material)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def mesh(name, vertices, faces):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    data.uv_layers.new()
    data.update()
    return data


def primitive(operator, **arguments):
    """The mesh that one of Blender's own operators adds, without its object."""
    getattr(bpy.ops.mesh, operator)(**arguments)
    thing = bpy.context.object
    data = thing.data
    bpy.data.objects.remove(thing)
    return data


def cube(name):
    data = primitive("primitive_cube_add", size=1.0)
    data.name = name
    return data


def square(name):
    """A unit square that faces +z, with texture coordinates."""
    data = primitive("primitive_plane_add", size=1.0)
    data.name = name
    return data


def wall_with_window():
    """A wall of 4 by 2.5, with a window of 1 by 1 in it; faces +z, its left lower corner at the origin."""
    xs, ys = [0.0, 1.5, 2.5, 4.0], [0.0, 1.0, 2.0, 2.5]
    vertices = [(x, y, 0.0) for y in ys for x in xs]
    faces = [
        (4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4)
        for j in range(3)
        for i in range(3)
        if (i, j) != (1, 1)
    ]
    return mesh("window wall", vertices, faces)


def light(name, kind, energy, colour=(1.0, 1.0, 1.0), **settings):
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = energy, colour
    for setting, value in settings.items():
        setattr(data, setting, value)
    return data


def camera(location, target, degrees, size):
    """The scene's camera, with this field of view across the picture's longer side."""
    data = bpy.data.cameras.new("Camera")
    data.angle = math.radians(degrees)
    thing = place("Camera", data, location=location)
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    scene = bpy.context.scene
    scene.camera = thing
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100


# Scenes


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)


def startup(_folder):
    """What Blender shows when it starts: cube, camera and point light."""
    bpy.ops.wm.read_factory_settings()


def room(folder, floor=None):
    """A room of 4 by 3 by 2.5 with a window, textured, metallic, glossy and emitting things and three lights.

    With `floor`, a colour, it is the untextured twin: plain materials of the colours that the rules of
    docs/scenes.md give the others.
    """
    empty()
    plain = floor is not None
    diffuse = {"roughness": 1.0, "specular": 0.0} if plain else {}
    walls = principled("walls", WHITE, **diffuse)
    box = square("square")
    ground = principled("floor", floor, **diffuse) if plain else textured("floor", checker(folder))
    place("floor", square("floor"), ground, (2, 1.5, 0), scale=(4, 3, 1))
    place("ceiling", box, walls, (2, 1.5, 2.5), (180, 0, 0), (4, 3, 1))
    place("left", square("left"), principled("left", RED, **diffuse), (0, 1.5, 1.25), (0, 90, 0), (2.5, 3, 1))
    place("right", square("right"), principled("right", GREEN, **diffuse), (4, 1.5, 1.25), (0, -90, 0), (2.5, 3, 1))
    place("front", box, walls, (2, 0, 1.25), (-90, 0, 0), (4, 2.5, 1))
    place("back", wall_with_window(), walls, (0, 3, 0), (90, 0, 0))

    panel = principled("panel", (0, 0, 0), emission=PANEL_RADIANCE, **diffuse)
    place("panel", cube("panel"), panel, (2.6, 1.4, 2.3), scale=(0.8, 0.5, 0.04))

    metal = principled("metal", GOLD, metallic=1.0, roughness=0.0 if plain else 0.1)
    ball = primitive("primitive_ico_sphere_add", subdivisions=2, radius=0.4)
    place("ball", ball, metal, (1.0, 2.0, 0.4))
    glossy = principled("glossy", BLUE, **(diffuse or {"roughness": 0.2}))
    place("box", cube("box"), glossy, (3.0, 2.0, 0.4), (0, 0, 30), (0.6, 0.6, 0.8))

    # One mesh three times: turned, then mirrored. It has no symmetry of its own.
    clay = principled("clay", CLAY, **diffuse)
    wedge = mesh(
        "wedge",
        [(0, 0, 0), (0.5, 0, 0), (0.4, 0.3, 0), (0, 0.3, 0), (0.1, 0.1, 0.6)],
        [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    )
    place("wedge", wedge, clay, (1.5, 0.9, 0.0))
    place("instance", wedge, clay, (2.6, 0.8, 0.0), (0, 0, 70), (1.2, 1.2, 1.2))
    place("mirrored", wedge, clay, (1.3, 0.9, 0.0), scale=(-1, 1, 1))

    # Without a size, and the spot with a sharp edge: then Blender's own pictures have the same illumination.
    # The exporter writes equal inner and outer angles for the sharp edge, which the extension does not allow.
    place("sun", light("sun", "SUN", 4.0, angle=0.0), location=(2, 6, 4), rotation=(-50, 0, 20))
    point = light("point", "POINT", 30.0, (1.0, 0.8, 0.6), shadow_soft_size=0.0)
    place("point", point, location=(0.5, 0.6, 1.8))
    spot = light("spot", "SPOT", 200.0, (0.6, 0.8, 1.0), shadow_soft_size=0.0, spot_blend=0.0)
    spot.spot_size = math.radians(50)
    place("spot", spot, location=(3.5, 0.5, 2.2), rotation=(25, 20, 0))
    camera((2.2, 0.15, 1.5), (1.95, 2.2, 0.8), 85, (480, 360))


def bust(_folder):
    """Something that stands upright: pedestal, shoulders and head, with a nose toward -y."""
    empty()
    stone = principled("stone", (0.6, 0.58, 0.55))
    pedestal = primitive("primitive_cylinder_add", vertices=16, radius=0.35, depth=0.8)
    place("pedestal", pedestal, stone, (0, 0, 0.4))
    ball = primitive("primitive_ico_sphere_add", subdivisions=3, radius=1.0)
    place("shoulders", ball, stone, (0, 0, 1.0), scale=(0.5, 0.3, 0.3))
    place("head", ball, stone, (0, 0, 1.6), scale=(0.26, 0.3, 0.36))
    place("nose", ball, stone, (0, -0.3, 1.58), scale=(0.05, 0.08, 0.08))


def spot(_folder):
    """A plate under a spot light with Blender's own settings, whose cone has a soft edge."""
    empty()
    place("plate", square("plate"), principled("plate", WHITE), scale=(4, 4, 1))
    place("spot", light("spot", "SPOT", 100.0), location=(0, 0, 3))
    camera((0, -5, 3), (0, 0, 0), 45, (480, 360))


def flat(_folder):
    """A floor plan: walls of height 0.2 on a plate of 8 by 5."""
    empty()
    paper = principled("paper", (0.8, 0.78, 0.7))
    place("plate", cube("plate"), paper, (4, 2.5, -0.05), scale=(8, 5, 0.1))
    brick = principled("brick", (0.5, 0.2, 0.15))
    wall = cube("wall")
    for index, (x, y, length, angle) in enumerate(
        [(4, 0.1, 7.8, 0), (4, 4.9, 7.8, 0), (0.1, 2.5, 4.6, 90), (7.9, 2.5, 4.6, 90), (3, 2, 3.6, 90), (5.5, 3, 4.6, 0)]
    ):
        place(f"wall {index}", wall, brick, (x, y, 0.1), (0, 0, angle), (length, 0.1, 0.2))


# Files


def glb(path):
    """As File > Export > glTF 2.0 does, with the boxes for cameras and punctual lights ticked."""
    bpy.ops.export_scene.gltf(
        filepath=str(path), export_format="GLB", export_cameras=True, export_lights=True, export_animations=False
    )


def obj(path, pbr=False):
    """As File > Export > Wavefront does."""
    bpy.ops.wm.obj_export(filepath=str(path), export_pbr_extensions=pbr, path_mode="STRIP")


def obj_z_up(path):
    """The same, with Blender's own axes and without texture coordinates."""
    bpy.ops.wm.obj_export(filepath=str(path), up_axis="Z", forward_axis="Y", export_uv=False, path_mode="STRIP")


def truth():
    """What Blender says of the scene that is open."""
    bpy.context.view_layer.update()
    rows = lambda matrix: [[round(x, 7) + 0.0 for x in row] for row in matrix]
    objects = {}
    for thing in sorted(bpy.context.scene.objects, key=lambda thing: thing.name):
        known = {"type": thing.type, "matrix": rows(thing.matrix_world)}
        if thing.type == "LIGHT":
            data = thing.data
            known |= {"light": data.type, "energy": data.energy, "colour": list(data.color)}
            if data.type == "SPOT":
                known |= {"outer_angle": data.spot_size / 2, "blend": data.spot_blend}
        if thing.type == "CAMERA":
            size = bpy.context.scene.render
            known |= {"angle": thing.data.angle, "size": [size.resolution_x, size.resolution_y]}
        if thing.type == "MESH":
            polygons = thing.data.polygons
            known |= {
                "material": thing.data.materials[0].name,
                "triangles": sum(len(polygon.vertices) - 2 for polygon in polygons),
            }
        objects[thing.name] = known
    return objects


def in_lines(said):
    """JSON with one object of a scene on each line."""
    text = lambda value: json.dumps(value, sort_keys=True)
    scene = lambda things: "{\n" + ",\n".join(f'    "{name}": {text(thing)}' for name, thing in things.items()) + "\n  }"
    rows = [f'  "{name}": {text(value) if isinstance(value, str) else scene(value)}' for name, value in said.items()]
    return "{\n" + ",\n".join(rows) + "\n}"


def main(folder):
    # The loader's grey stands for the textured floor.
    scenes = {
        "startup": (startup, [("startup.glb", glb, {})]),
        "room": (room, [("room.glb", glb, {}), ("room.obj", obj, {}), ("room_pbr.obj", obj, {"pbr": True})]),
        "room_plain": (
            lambda folder: room(folder, (0.5, 0.5, 0.5)),
            [("room_plain.glb", glb, {}), ("room_plain.obj", obj, {})],
        ),
        "bust": (bust, [("bust.obj", obj_z_up, {})]),
        "spot": (spot, [("spot.glb", glb, {})]),
        "flat": (flat, [("flat.glb", glb, {})]),
    }
    said = {"blender": bpy.app.version_string}
    for name, (build, files) in scenes.items():
        build(folder)
        said[name] = truth()
        for file, export, arguments in files:
            export(folder / file, **arguments)
    (folder / "truth.json").write_text(in_lines(said) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE)
