# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the viewport's dependency graph show what a render would, and puts everything back.

Scripts only get the viewport's graph. Where viewport and render settings of an object, collection
or modifier differ, the viewport's are set to the render's while the context lasts.
"""

from contextlib import contextmanager

from .compat import has

# Modifier settings for the viewport -> the same for renders.
_PAIRS = {
    "SUBSURF": (("levels", "render_levels"),),
    "MULTIRES": (("levels", "render_levels"),),
    "SCREW": (("steps", "render_steps"),),
    "OCEAN": (("viewport_resolution", "resolution"),),
}


@contextmanager
def render_view(context, always=frozenset()):
    """Yields (depsgraph, names of render-visible objects) as a render would see the scene. Objects
    named in always count as visible."""
    view_layer = context.view_layer
    view_layer.update()  # scripts may just have linked objects
    undo = []
    try:
        visible = set()
        _align_collections(view_layer.layer_collection, undo, visible, always, True)
        for obj in view_layer.objects:
            if obj.mode == "EDIT":
                obj.update_from_editmode()
            _align_object(obj, view_layer, undo, always)
        for obj in _instanced_objects(view_layer.objects):
            if obj.name_full in always:
                _set(obj, "hide_viewport", False, undo)
                visible.add(obj.name_full)
            _align_modifiers(obj, undo)
        view_layer.update()
        yield context.evaluated_depsgraph_get(), visible
    finally:
        for restore in reversed(undo):
            restore()
        if undo:
            view_layer.update()


def _set(owner, name, value, undo):
    """Sets a property if it differs; linked data that refuses is left alone."""
    old = getattr(owner, name)
    if old == value:
        return
    try:
        setattr(owner, name, value)
    except (AttributeError, RuntimeError):
        return
    undo.append(lambda: setattr(owner, name, old))


def _align_collections(layer_collection, undo, visible, always, shown):
    """Shows what renders; collects the names of objects in collections that render."""
    if layer_collection.exclude:
        return
    collection = layer_collection.collection
    shown = shown and not collection.hide_render
    _set(layer_collection, "hide_viewport", False, undo)
    if collection.hide_viewport and (shown or any(o.name_full in always for o in collection.all_objects)):
        _set(collection, "hide_viewport", False, undo)
    names = {o.name_full for o in collection.objects if shown and not o.hide_render}
    visible.update(names | {o.name_full for o in collection.objects if o.name_full in always})
    for child in layer_collection.children:
        _align_collections(child, undo, visible, always, shown)


def _align_object(obj, view_layer, undo, always):
    if obj.hide_render and obj.name_full not in always:
        return
    _set(obj, "hide_viewport", False, undo)
    if obj.hide_get(view_layer=view_layer):
        obj.hide_set(False, view_layer=view_layer)
        undo.append(lambda: obj.hide_set(True, view_layer=view_layer))
    _align_modifiers(obj, undo)


def _align_modifiers(obj, undo):
    for modifier in obj.modifiers:
        _set(modifier, "show_viewport", modifier.show_render, undo)
        for viewport, render in _PAIRS.get(modifier.type, ()):
            if has(modifier, viewport) and has(modifier, render):
                _set(modifier, viewport, getattr(modifier, render), undo)
    data = obj.data
    if getattr(data, "render_resolution_u", 0) > 0:
        _set(data, "resolution_u", data.render_resolution_u, undo)
        _set(data, "resolution_v", data.render_resolution_v or data.resolution_v, undo)


def _instanced_objects(objects):
    """Objects reached only through collection instances."""
    found = {}
    for obj in objects:
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            found.update({o.name_full: o for o in obj.instance_collection.all_objects})
    return list(found.values())


def rendered(instance, visible):
    """Whether a depsgraph instance is part of a render (visible: from render_view)."""
    obj = instance.object.original
    if instance.is_instance:
        parent = instance.parent.original if instance.parent is not None else None
        collections = obj.users_collection
        hidden = obj.hide_render or (collections and all(c.hide_render for c in collections))
        return (not hidden or obj.name_full in visible) and (parent is None or parent.name_full in visible)
    if obj.instance_type in {"VERTS", "FACES"} and not obj.show_instancer_for_render:
        return False
    return obj.name_full in visible
