"""A good data sheet, as texts."""

GRANITE = {
    "density": "2650 kg/m^3", "E": "55 GPa", "nu": "0.25", "UCS": "160 MPa", "phi": "50 deg", "sigma_t": "9 MPa",
    "K_Ic": "1.4 MPa*m^0.5",
}  # fmt: skip


def text_of(values: dict[str, str], head: str = "") -> str:
    return head + "[rock]\n" + "".join(f'{key} = "{value}"\n' for key, value in values.items())
