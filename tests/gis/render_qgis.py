#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""render_qgis.py RESULTS [PICTURES]: opens a folder of results in QGIS as a user would and checks what the user would see.

Every vector layer of results.gpkg and every GeoTIFF is opened on its own: it must be valid, lie where it should and carry the
style that was written, not QGIS' default. Then the project is opened, checked and drawn to PICTURES/*.png. The folder is copied
elsewhere first, because results are moved. Ends with 77 where QGIS is not installed.
"""

import glob
import os
import shutil
import sys
import tempfile

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.mkdtemp())  # QGIS wants it for its user only
try:
    from qgis.core import (
        Qgis, QgsApplication, QgsLayerTreeModel, QgsLegendRenderer, QgsLegendSettings, QgsMapRendererParallelJob, QgsMapSettings,
        QgsProject, QgsRasterLayer, QgsRectangle, QgsRenderContext, QgsVectorLayer)
    from qgis.PyQt.QtCore import QRectF, QSize
    from qgis.PyQt.QtGui import QColor, QImage, QPainter
except ImportError:
    print("QGIS is not installed: skipped")
    sys.exit(77)

EXPECTED_CRS = "EPSG:2154"
EXPECTED_BOX = QgsRectangle(903000, 6455000, 903300, 6455600)
RENDERERS = {  # layer: its default style, and how QGIS names it
    "stopping_points": ("By mass", "graduatedSymbol"),
    "release_points": ("Default", "singleSymbol"),
    "screens": ("Default", "singleSymbol"),
    "trajectories": ("By largest speed", "graduatedSymbol"),
    "deposit_zones": ("By share of the deposits", "graduatedSymbol"),
}
failures = []


def check(condition, sentence):
    if not condition:
        failures.append(sentence)
        print("FAILED:", sentence)


def check_place(layer, what):
    check(layer.isValid(), f"{what}: QGIS cannot open it")
    check(layer.crs().authid() == EXPECTED_CRS, f"{what}: CRS is {layer.crs().authid()}, not {EXPECTED_CRS}")
    grown = QgsRectangle(EXPECTED_BOX).buffered(1.0)
    check(not layer.extent().isEmpty() and grown.contains(layer.extent()),
          f"{what}: extent {layer.extent().toString()} is not inside {EXPECTED_BOX.toString()}")


def legend_labels(layer):
    if isinstance(layer, QgsRasterLayer):
        return [item.label for item in layer.renderer().shader().rasterShaderFunction().colorRampItemList()]
    return [item.label() for item in layer.renderer().legendSymbolItems()]


def check_vector(folder, name):
    layer = QgsVectorLayer(f"{folder}/results.gpkg|layername={name}", name, "ogr")
    check_place(layer, name)
    style, renderer = RENDERERS[name]
    check(layer.renderer().type() == renderer, f"{name}: renderer is {layer.renderer().type()}, not {renderer}")
    _, loaded = layer.loadDefaultStyle()
    check(loaded, f"{name}: the database holds no default style")
    count, ids, names, _, _ = layer.listStylesInDatabase()
    check(style in names[:max(count, 1)], f"{name}: the style {style} is not among {names}")
    check(all(layer.attributeAlias(i) for i in range(1, layer.fields().count())), f"{name}: a field has no alias")
    if name == "stopping_points":
        check(any("kg" in label for label in legend_labels(layer)), f"{name}: no unit in {legend_labels(layer)}")
        counted = sum(layer.renderer().symbolForValue(f["mass_kg"]) is not None for f in layer.getFeatures())
        check(counted == layer.featureCount(), f"{name}: {layer.featureCount() - counted} points have no symbol")
    if name == "deposit_zones":
        check(layer.labelsEnabled(), f"{name}: labels are off")


def check_raster(path):
    name = os.path.splitext(os.path.basename(path))[0]
    layer = QgsRasterLayer(path, name)
    check_place(layer, name)
    check(layer.extent() == EXPECTED_BOX, f"{name}: extent {layer.extent().toString()} is not {EXPECTED_BOX.toString()}")
    expected = "hillshade" if name.startswith("terrain") else "singlebandpseudocolor"
    check(layer.renderer().type() == expected, f"{name}: renderer is {layer.renderer().type()}, not {expected}")
    if name.startswith("energy"):
        check("30 – 100 kJ (medium)" in legend_labels(layer), f"{name}: legend reads {legend_labels(layer)}")


def draw(layers, extent, crs, size):
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setDestinationCrs(crs)
    settings.setExtent(extent)
    settings.setOutputSize(size)
    settings.setOutputDpi(120)
    settings.setBackgroundColor(QColor("white"))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    check(not job.errors(), f"drawing failed: {[error.message for error in job.errors()]}")
    return job.renderedImage()


def add_legend(picture, project, shown):
    """The map with the legend of the layers shown at its right."""
    root = project.layerTreeRoot().clone()
    for node in root.findLayers():
        if node.layer() not in shown:
            node.parent().removeChildNode(node)
    for group in root.findGroups():
        if not group.findLayers():
            root.removeChildNode(group)
    width = 420
    image = QImage(picture.width() + width, picture.height(), QImage.Format_ARGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.drawImage(0, 0, picture)
    painter.translate(picture.width() + 20, 20)
    dots_per_mm = 4.0
    painter.scale(dots_per_mm, dots_per_mm)
    context = QgsRenderContext.fromQPainter(painter)
    context.setScaleFactor(1.0)
    model = QgsLayerTreeModel(root)  # the renderer does not keep it alive
    legend = QgsLegendRenderer(model, QgsLegendSettings())
    legend.drawLegend(context)
    painter.end()
    return image


def colours(image):
    step = 7
    return {image.pixel(x, y) for x in range(0, image.width(), step) for y in range(0, image.height(), step)}


def check_project(folder, pictures):
    project = QgsProject.instance()
    check(project.read(f"{folder}/results.qgs"), "results.qgs: QGIS cannot read it")
    check(project.crs().authid() == EXPECTED_CRS, f"results.qgs: CRS is {project.crs().authid()}, not {EXPECTED_CRS}")
    layers = list(project.mapLayers().values())
    rasters = glob.glob(f"{folder}/rasters/*.tif")
    check(len(layers) == len(RENDERERS) + len(rasters), f"results.qgs: {len(layers)} layers")
    for layer in layers:
        check_place(layer, f"results.qgs, {layer.name()}")
        check(layer.source().startswith(folder), f"results.qgs, {layer.name()}: is read from {layer.source()}")
        if isinstance(layer, QgsVectorLayer):
            name = layer.source().split("layername=")[1]
            check(layer.renderer().type() == RENDERERS[name][1], f"results.qgs, {name}: renderer {layer.renderer().type()}")
    root = project.layerTreeRoot()
    groups = [group.name() for group in root.findGroups()]
    check(groups[:1] == ["Blocks"] and "Kinetic energy" in groups, f"results.qgs: groups are {groups}")

    order = root.layerOrder()
    visible = [layer for layer in order if root.findLayer(layer.id()).isVisible()]
    check(len(visible) == len(RENDERERS) + 2, f"results.qgs: {[layer.name() for layer in visible]} are switched on")
    extent = EXPECTED_BOX.buffered(10.0)
    size = QSize(800, 1500)
    terrain = [layer for layer in order if layer.name().startswith("Terrain")]
    whole = draw(visible, extent, project.crs(), size)
    check(len(colours(whole)) > 100, "the map has hardly any colours")
    if pictures:
        os.makedirs(pictures, exist_ok=True)
        add_legend(whole, project, visible).save(f"{pictures}/project.png")
    for layer in order:
        if isinstance(layer, QgsRasterLayer):
            picture = draw([layer] + terrain, extent, project.crs(), size)
            check(len(colours(picture)) > 5, f"{layer.name()}: the picture has hardly any colours")
            if pictures:
                name = os.path.splitext(os.path.basename(layer.source()))[0]
                add_legend(picture, project, [layer]).save(f"{pictures}/{name}.png")


def main():
    pictures = sys.argv[2] if len(sys.argv) > 2 else ""
    folder = os.path.join(tempfile.mkdtemp(), "moved", "elsewhere")
    shutil.copytree(sys.argv[1], folder)
    application = QgsApplication([], False)
    application.initQgis()
    for name in RENDERERS:
        check_vector(folder, name)
    for path in sorted(glob.glob(f"{folder}/rasters/*.tif")):
        check_raster(path)
    check_project(folder, pictures)
    shutil.rmtree(os.path.dirname(os.path.dirname(folder)))
    print(f"QGIS {Qgis.QGIS_VERSION}: {len(failures)} failures")
    sys.stdout.flush()
    os._exit(1 if failures else 0)  # QGIS' own clean-up crashes without a screen


main()
