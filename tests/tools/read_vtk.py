"""Reads an exported record with VTK's reader and prints what is in it. Exit status 77: VTK is not installed."""

import math
import pathlib
import sys
import xml.etree.ElementTree

try:
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
except ImportError:
    sys.exit(77)

collection = pathlib.Path(sys.argv[1])
for row in xml.etree.ElementTree.parse(collection).getroot().iter("DataSet"):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(collection.parent / row.get("file")))
    reader.Update()
    grid = reader.GetOutput()
    cells, points = grid.GetCellData(), grid.GetPointData()
    tension, part, force = cells.GetArray("tension"), cells.GetArray("part"), points.GetArray("tip_force")
    of_plates = [tension.GetValue(i) for i in range(grid.GetNumberOfCells()) if part.GetValue(i) == 1]
    axial = sum(abs(force.GetComponent(i, 2)) for i in range(grid.GetNumberOfPoints()))
    plane = sum(math.hypot(force.GetComponent(i, 0), force.GetComponent(i, 1)) for i in range(grid.GetNumberOfPoints()))
    print(row.get("timestep"), grid.GetNumberOfCells(), repr(sum(of_plates)), repr(axial), repr(plane),
          *(repr(number) for number in grid.GetPoint(2)))
