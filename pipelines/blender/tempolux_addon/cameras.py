"""Cameras: Blender's sensor, fit, shift, pixel aspect and border as a field of view and a shift."""
import math

import numpy


class CameraState:
    """A camera at a frame. half: half height of the picture at distance 1, or in metres (orthographic); shift in heights of the picture."""

    def __init__(self, kind, half, shift, aspect, extras):
        self.kind, self.half, self.shift, self.aspect, self.extras = kind, half, shift, aspect, extras

    def gltf(self):
        width = self.half * self.aspect
        if self.kind == "ORTHO":
            return {
                "type": "orthographic",
                "orthographic": {"xmag": width, "ymag": self.half, "znear": 0.01, "zfar": 1000},
            }
        return {
            "type": "perspective",
            "perspective": {"yfov": 2 * math.atan(self.half), "aspectRatio": self.aspect, "znear": 0.01},
        }

    def ray(self, place, x, y):
        """Origin and direction in Blender's world of the ray through (x, y) of the picture, (0, 0) its top left."""
        across = 2 * self.half * (self.aspect * (x - .5) + self.shift[0])
        up = 2 * self.half * (.5 - y + self.shift[1])
        turn = place[:3, :3] / numpy.linalg.norm(place[:3, :3], axis=0)
        if self.kind == "ORTHO":
            return place[:3, 3] + turn @ (across, up, 0), turn @ (0, 0, -1)
        way = turn @ (across, up, -1)
        return place[:3, 3], way / numpy.linalg.norm(way)

    def shows(self, place, point):
        """Is a point of Blender's world in the picture, or a tenth of it beside?"""
        local = (point - place[:3, 3]) @ (place[:3, :3] / numpy.linalg.norm(place[:3, :3], axis=0))
        away = 1.0 if self.kind == "ORTHO" else -local[2]
        if away <= 0:
            return False
        x, y = (local[k] / away / (2 * self.half) - self.shift[k] for k in (0, 1))
        return abs(x) < .6 * self.aspect and abs(y) < .6


def picture_size(render):
    """Width and height in square pixels: the border alone where the render is cropped to it."""
    share = render.resolution_percentage / 100
    least = min(render.pixel_aspect_x, render.pixel_aspect_y)
    width = render.resolution_x * share * render.pixel_aspect_x / least
    height = render.resolution_y * share * render.pixel_aspect_y / least
    x0, x1, y0, y1 = border(render)
    return max(1, round(width * (x1 - x0))), max(1, round(height * (y1 - y0)))


def border(render):
    if not (render.use_border and render.use_crop_to_border):
        return 0.0, 1.0, 0.0, 1.0
    return render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y


def camera_state(thing, place, scene):
    lens, render = thing.data, scene.render
    wide = render.resolution_x * render.pixel_aspect_x
    high = render.resolution_y * render.pixel_aspect_y
    fit = lens.sensor_fit if lens.sensor_fit != "AUTO" else "HORIZONTAL" if wide >= high else "VERTICAL"
    sensor = lens.sensor_height if lens.sensor_fit == "VERTICAL" else lens.sensor_width
    whole = (
        lens.ortho_scale / 2 if lens.type == "ORTHO" else sensor / lens.lens / 2
    )  # half of the side that fits the sensor
    fitted = wide if fit == "HORIZONTAL" else high
    half = whole * high / fitted
    shift = lens.shift_x * fitted / high, lens.shift_y * fitted / high
    x0, x1, y0, y1 = border(render)
    part = y1 - y0
    shift = ((shift[0] + ((x0 + x1) / 2 - .5) * wide / high) / part, (shift[1] + (y0 + y1) / 2 - .5) / part)
    return CameraState(
        "ORTHO" if lens.type == "ORTHO" else "PERSP",
        half * part,
        shift,
        wide * (x1 - x0) / (high * part),
        extras_of(lens, place, render),
    )


def extras_of(lens, place, render):
    extras = {"lens_mm": lens.lens, "sensor_width_mm": lens.sensor_width, "shutter_frames": 0.0}
    if render.use_motion_blur:
        extras["shutter_frames"] = render.motion_blur_shutter
        extras["shutter_position"] = getattr(render, "motion_blur_position", "CENTER").lower()
    if lens.dof.use_dof:
        extras["f_stop"] = lens.dof.aperture_fstop
        target = lens.dof.focus_object
        if target:
            way = numpy.array(target.matrix_world.translation) - place[:3, 3]
            extras["focus_m"] = abs(float(way @ place[:3, 2] / numpy.linalg.norm(place[:3, 2])))
        else:
            extras["focus_m"] = lens.dof.focus_distance
    return extras
