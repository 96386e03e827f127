"""Files of other fields, read and written by the libraries that know them; each brought by an extra.

| files | functions | extra |
|---|---|---|
| NIfTI volumes and masks | `read_nifti`, `read_nifti_volume`, `write_nifti` | ``bitvox[medical]`` (nibabel) |
| DICOM series, RTSTRUCT contours | `read_dicom`, `read_dicom_volume`, `read_rtstruct`, `bitvox.from_sections` | ``bitvox[medical]`` (pydicom) |
| DICOM segmentations (SEG), RTSTRUCT written | `read_segmentation`, `write_segmentation`, `write_rtstruct` | ``bitvox[medical]`` (highdicom, pydicom) |
| stacks of slice images | `read_images`, `write_images` | ``bitvox[formats]`` (Pillow) |
| DXF polylines | `read_dxf`, `bitvox.from_sections` | ``bitvox[geo]`` (ezdxf) |
| DAE ... meshes | `bitvox.read` | ``bitvox[formats]`` (trimesh) |
| AMF, plain and zipped | `bitvox.read`, `read_amf` | none |
"""

from .amf import read_amf
from .dicom import read_dicom, read_dicom_volume, read_rtstruct
from .dicom_written import read_segmentation, write_rtstruct, write_segmentation
from .dxf import read_dxf
from .images import read_images, write_images
from .nifti import read_nifti, read_nifti_volume, write_nifti
from .other import read_other

__all__ = ["read_amf", "read_dicom", "read_dicom_volume", "read_dxf", "read_images", "read_nifti", "read_nifti_volume", "read_other",
           "read_rtstruct", "read_segmentation", "write_images", "write_nifti", "write_rtstruct", "write_segmentation"]
