# SPDX-License-Identifier: Apache-2.0
"""Renders scenes in Blender: one JSON document a line comes in, one line goes out for each.

Runs inside Blender (3.4): blender --background --factory-startup --python render_scenes.py
"""
import json
import math
import sys

import bpy
import mathutils

SIDES = 48  # Number of sides of round shapes.


def say(message):
    sys.stdout.write("engram: " + json.dumps(message) + "\n")
    sys.stdout.flush()


def matrix(values):
    return mathutils.Matrix([values[0:4], values[4:8], values[8:12], values[12:16]])


def linear(channel):
    """From sRGB to the linear light that Blender computes in."""
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


def empty_file():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 30
    scene.render.dither_intensity = 0.0
    # Without bounces, light comes straight from lamps and surroundings, so a part changes only its
    # own pixels and its shadow.
    cycles = scene.cycles
    cycles.max_bounces = 0
    cycles.diffuse_bounces = 0
    cycles.glossy_bounces = 0
    cycles.caustics_reflective = False
    cycles.caustics_refractive = False
    cycles.use_denoising = False
    cycles.seed = 0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    return scene


# --- Shapes: vertices, faces and, for each corner of a face, its place in the picture ---


def round_profile(kind, half):
    """Radius (times that of the shape) and height of rings, from below."""
    if kind == "cylinder":
        return [(0.0, -half[2]), (1.0, -half[2]), (1.0, half[2]), (0.0, half[2])]
    rings = 12
    angles = [math.pi * (i / (2 * rings) - 0.5) for i in range(2 * rings + 1)]
    if kind == "ellipsoid":
        return [(math.cos(a), half[2] * math.sin(a)) for a in angles]
    straight = half[2] - half[0]
    return [(math.cos(a), half[0] * math.sin(a) + math.copysign(straight, a)) for a in angles]


def box_mesh(half):
    x, y, z = half
    corners = [(a * x, b * y, c * z) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]
    faces = [(4, 6, 7, 5), (0, 1, 3, 2), (2, 3, 7, 6), (0, 4, 5, 1), (1, 5, 7, 3), (0, 2, 6, 4)]
    return corners, faces


def round_mesh(kind, half):
    corners, faces, rings = [], [], []
    for radius, height in round_profile(kind, half):
        if radius < 1e-9:
            rings.append([len(corners)])
            corners.append((0.0, 0.0, height))
            continue
        rings.append(list(range(len(corners), len(corners) + SIDES)))
        for i in range(SIDES):
            angle = 2 * math.pi * i / SIDES
            corners.append(
                (half[0] * radius * math.cos(angle), half[1] * radius * math.sin(angle), height))
    for lower, upper in zip(rings, rings[1:]):
        for i in range(SIDES):
            k = (i + 1) % SIDES
            if len(lower) == 1 and len(upper) == 1:
                continue
            if len(lower) == 1:
                faces.append((lower[0], upper[k], upper[i]))
            elif len(upper) == 1:
                faces.append((lower[i], lower[k], upper[0]))
            else:
                faces.append((lower[i], lower[k], upper[k], upper[i]))
    return corners, faces


def cube_place(point, normal):
    """Place in a strip of six faces of a direction from the middle, on the face that the normal names."""
    axis = max(range(3), key=lambda i: abs(normal[i]))
    face = 2 * axis + (0 if normal[axis] > 0 else 1)
    # The directions right and up of each face, seen from outside.
    right, up = [((0, 1, 0), (0, 0, 1)), ((0, -1, 0), (0, 0, 1)), ((-1, 0, 0), (0, 0, 1)),
                 ((1, 0, 0), (0, 0, 1)), ((0, 1, 0), (-1, 0, 0)), ((0, 1, 0), (1, 0, 0))][face]
    u = 0.5 + 0.5 * sum(a * b for a, b in zip(right, point))
    v = 0.5 + 0.5 * sum(a * b for a, b in zip(up, point))
    inset = 0.002
    u = min(max(u, inset), 1 - inset)
    v = min(max(v, inset), 1 - inset)
    return u, 1 - (face + 1 - v) / 6


def picture_places(mesh, shape):
    half = shape["half"]
    layer = mesh.uv_layers.new(name="picture")
    for polygon in mesh.polygons:
        for loop in polygon.loop_indices:
            corner = mesh.vertices[mesh.loops[loop].vertex_index].co
            point = [corner[i] / half[i] for i in range(3)]
            if shape["way"] == "cube":
                normal = [polygon.normal[i] * half[i] for i in range(3)] \
                    if shape["kind"] != "box" else polygon.normal
                layer.data[loop].uv = cube_place(point, normal)
            else:
                layer.data[loop].uv = (shape["repeat"][0] * (0.5 + 0.5 * point[0]),
                                       shape["repeat"][1] * (0.5 + 0.5 * point[1]))


def material_of(shape, textures, ambient):
    material = bpy.data.materials.new("part")
    material.use_nodes = True
    material.cycles.sample_as_light = False
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = nodes["Principled BSDF"]
    surface.inputs["Roughness"].default_value = shape["roughness"]
    surface.inputs["Specular"].default_value = 0.5 * (1 - shape["roughness"])
    colour = [linear(c) for c in shape["colour"]] + [1.0]
    surface.inputs["Base Color"].default_value = colour
    # Ambient light, which nothing shades, is emitted by the surface and seen only by the camera.
    own = [c * (linear(a) + shape["emission"]) for c, a in zip(colour, ambient)] + [1.0]
    surface.inputs["Emission"].default_value = own
    path = nodes.new("ShaderNodeLightPath")
    links.new(path.outputs["Is Camera Ray"], surface.inputs["Emission Strength"])
    if shape["texture"] >= 0:
        picture = nodes.new("ShaderNodeTexImage")
        picture.image = bpy.data.images.load(textures[shape["texture"]], check_existing=True)
        for socket, factor in (("Base Color", colour), ("Emission", own)):
            tint = nodes.new("ShaderNodeMixRGB")
            tint.blend_type = "MULTIPLY"
            tint.inputs["Fac"].default_value = 1.0
            tint.inputs["Color2"].default_value = factor
            links.new(picture.outputs["Color"], tint.inputs["Color1"])
            links.new(tint.outputs["Color"], surface.inputs[socket])
    return material


def add_shape(scene, shape, textures, ambient):
    make = box_mesh if shape["kind"] == "box" else lambda half: round_mesh(shape["kind"], half)
    corners, faces = make(shape["half"])
    mesh = bpy.data.meshes.new("part")
    mesh.from_pydata(corners, [], faces)
    mesh.update()
    if shape["kind"] != "box":
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = math.radians(50)
        for polygon in mesh.polygons:
            polygon.use_smooth = True
    if shape["texture"] >= 0:
        picture_places(mesh, shape)
    mesh.materials.append(material_of(shape, textures, ambient))
    part = bpy.data.objects.new("part", mesh)
    part.matrix_world = matrix(shape["pose"])
    part.visible_camera = shape["is_seen"]
    scene.collection.objects.link(part)


def add_lamp(scene, lamp):
    kind = "SUN" if lamp["kind"] == "sun" else "POINT"
    light = bpy.data.lights.new("lamp", kind)
    light.energy = lamp["strength"]
    light.color = [linear(c) for c in lamp["colour"]]
    if kind == "SUN":
        light.angle = lamp["size"]
    else:
        light.shadow_soft_size = lamp["size"]
    light.cycles.cast_shadow = lamp["casts_shadow"]
    if kind == "POINT" and not lamp["falls_off"]:
        light.use_nodes = True
        nodes, links = light.node_tree.nodes, light.node_tree.links
        falloff = nodes.new("ShaderNodeLightFalloff")
        falloff.inputs["Strength"].default_value = 1.0
        links.new(falloff.outputs["Constant"], nodes["Emission"].inputs["Strength"])
    part = bpy.data.objects.new("lamp", light)
    part.matrix_world = matrix(lamp["pose"])
    scene.collection.objects.link(part)


def set_camera(scene, camera):
    width, height = camera["width"], camera["height"]
    lens = bpy.data.cameras.new("camera")
    lens.sensor_fit = "HORIZONTAL"
    lens.sensor_width = 36.0
    lens.lens = 36.0 * camera["fx"] / width
    lens.clip_start = 0.01
    # Coordinates in recordings count from the middle of the first pixel, Blender's from the border.
    lens.shift_x = (0.5 * width - (camera["cx"] + 0.5)) / width
    lens.shift_y = ((camera["cy"] + 0.5) - 0.5 * height) / width * camera["fx"] / camera["fy"]
    part = bpy.data.objects.new("camera", lens)
    # Blender's cameras look along -z with y up.
    part.matrix_world = matrix(camera["pose"]) @ mathutils.Matrix.Diagonal((1, -1, -1, 1))
    scene.collection.objects.link(part)
    scene.camera = part
    scene.render.resolution_x = width
    scene.render.resolution_y = height
    scene.render.resolution_percentage = 100
    scene.render.pixel_aspect_x = 1.0
    scene.render.pixel_aspect_y = 1.0
    ratio = camera["fx"] / camera["fy"]
    if ratio > 1:
        scene.render.pixel_aspect_y = ratio
    else:
        scene.render.pixel_aspect_x = 1 / ratio


def render(job):
    scene = empty_file()
    scene.render.threads_mode = "FIXED"
    scene.render.threads = job["threads"]
    scene.cycles.samples = job["samples"]
    scene.cycles.use_adaptive_sampling = job["noise"] > 0
    scene.cycles.adaptive_threshold = job["noise"]
    scene.cycles.adaptive_min_samples = min(16, job["samples"])
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = \
        [0.0, 0.0, 0.0, 1.0]
    scene.world = world
    for shape in job["shapes"]:
        add_shape(scene, shape, job["textures"], job["ambient"])
    for lamp in job["lamps"]:
        add_lamp(scene, lamp)
    set_camera(scene, job["camera"])
    scene.render.filepath = job["file"]
    bpy.ops.render.render(write_still=True)


def main():
    say({"ready": bpy.app.version_string})
    for line in sys.stdin:
        job = json.loads(line)
        try:
            render(job)
            say({"number": job["number"]})
        except Exception as error:  # The caller gets the error; the next scene may work.
            say({"number": job["number"], "error": str(error)})


main()
