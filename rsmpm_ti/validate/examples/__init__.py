"""The paper's two examples, flawed specimens, and what decides about them."""
